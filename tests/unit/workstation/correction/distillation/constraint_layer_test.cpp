#include "workstation/correction/distillation/constraint_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/action.h"
#include "shared/host/user_error.h"
#include "tests/support/correction_cases.h"
#include "tests/support/tokens.h"
#include "workstation/correction/distillation/correction_layer.h"
#include "workstation/correction/distillation/distil.h"

namespace bess {
namespace {

using testing::ThrowsMessage;

constexpr Difference kU = Difference::kU;
constexpr Difference kV = Difference::kV;

/// Logits of two states, by their differences.
Eigen::MatrixXd logits_of_pairs(const std::vector<std::pair<double, double>>& differences) {
  Eigen::MatrixXd logits(kActionCount, static_cast<Eigen::Index>(differences.size()));
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    const auto& [u, v] = differences[static_cast<std::size_t>(c)];
    logits.col(c) << -v, 0, u;
  }
  return logits;
}

std::vector<double> differences_of_states(const Eigen::MatrixXd& logits) {
  std::vector<double> differences;
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    differences.push_back(logits(2, c) - logits(1, c));
    differences.push_back(logits(1, c) - logits(0, c));
  }
  return differences;
}

TEST(ConstraintLayer, GivesTheIsotonicLayersAnswer) {
  Random random(401);
  for (const LayerCase& c : kLayerCases) {
    const LatticeAxes axes = even_axes(c.prices, c.socs);
    CorrectionLayer isotonic(c.options, c.prices, c.socs);
    ConstraintLayer general(property_rows(c.options, axes), c.prices * c.socs);
    for (const double spread : {0.1, 1.5, 20.0}) {
      SCOPED_TRACE(testing::Message() << c.name << ", spread " << spread);
      const Eigen::MatrixXd logits = random_logits(c.prices * c.socs, random, spread);
      const Eigen::MatrixXd gradient = random_logits(c.prices * c.socs, random, 1);
      Eigen::MatrixXd expected, expected_back, corrected, back;
      isotonic.forward(axes, logits, expected);
      isotonic.backward(gradient, expected_back);
      general.forward(logits, corrected);
      general.backward(gradient, back);
      EXPECT_LT((corrected - expected).cwiseAbs().maxCoeff(), 1e-9 * (1 + spread));
      EXPECT_LT((back - expected_back).cwiseAbs().maxCoeff(), 1e-7);
    }
  }
}

TEST(ConstraintLayer, RowsOfOneState) {
  const std::vector<DifferenceRow> rows{
      {"reserve", {{1, kV, 1}}, 0.5},  // does not discharge
      {"cheap", {{2, kU, 1}}, 1},      // charges
      {"cheap", {{2, kV, 1}}, 0},
      {"not up", {{3, kU, 1}, {3, kV, 1}}, 2},  // charge beats discharge by 2
      {"even", {{4, kU, 1}, {4, kV, -1}}, 0},   // u >= v
  };
  ConstraintLayer layer(rows, 6);
  Eigen::MatrixXd corrected;
  const Eigen::MatrixXd logits =
      logits_of_pairs({{-7, -9}, {-1, -3}, {-2, -4}, {-1, 1}, {1, 5}, {2, 3}});
  layer.forward(logits, corrected);
  const std::vector<double> expected{-7, -9, -1, 0.5, 1, 0, 0, 2, 3, 3, 2, 3};
  EXPECT_THAT(differences_of_states(corrected),
              testing::Pointwise(testing::DoubleNear(1e-12), expected));
  EXPECT_LT((corrected.colwise().mean() - logits.colwise().mean()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ConstraintLayer, WithoutRowsNothingMoves) {
  Random random(402);
  const Eigen::MatrixXd logits = random_logits(5, random, 2);
  const Eigen::MatrixXd gradient = random_logits(5, random, 1);
  ConstraintLayer layer({}, 5);
  Eigen::MatrixXd corrected, back;
  layer.forward(logits, corrected);
  layer.backward(gradient, back);
  EXPECT_LT((corrected - logits).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((back - gradient).cwiseAbs().maxCoeff(), 1e-12);
}

/// The paper's properties and an operator's rule: no discharge in a box; and a total over states.
std::vector<DifferenceRow> rows_with_rules(const CorrectionOptions& options,
                                           const LatticeAxes& axes) {
  std::vector<DifferenceRow> rows = property_rows(options, axes);
  const auto socs = static_cast<int>(axes.soc.size());
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 3; ++j) rows.push_back({"keep a reserve", {{i * socs + j, kV, 1}}, 0.5});
  }
  DifferenceRow total{"charge on the whole", {}, 4};
  for (int i = 0; i < 10; ++i) total.terms.push_back({i * socs, i % 2 == 0 ? kU : kV, 1});
  rows.push_back(total);
  return rows;
}

TEST(ConstraintLayer, RulesHoldTogetherWithTheProperties) {
  Random random(403);
  const CorrectionOptions options;
  const LatticeAxes axes = even_axes(12, 6);
  const std::vector<DifferenceRow> rows = rows_with_rules(options, axes);
  ConstraintLayer layer(rows, 72);
  Eigen::MatrixXd corrected, again;
  layer.forward(random_logits(72, random, 2), corrected);
  const std::vector<double> differences = differences_of_states(corrected);
  for (const DifferenceRow& row : rows) {
    double value = 0;
    for (const DifferenceTerm& term : row.terms) {
      value +=
          term.factor *
          differences[static_cast<std::size_t>(2 * term.state) + (term.difference == kV ? 1 : 0)];
    }
    EXPECT_GE(value, row.bound - 1e-9) << row.rule;
  }
  layer.forward(corrected, again);
  EXPECT_LT((again - corrected).cwiseAbs().maxCoeff(), 1e-9) << "the correction is idempotent";
}

TEST(ConstraintLayer, ContradictingRulesAreNamed) {
  const std::vector<DifferenceRow> rows{
      {"bystander", {{0, kU, 1}}, 3},
      {"never charge when dear", {{4, kU, -1}}, 1},
      {"monotone in price", {{3, kU, 1}, {4, kU, -1}}, 0.1},
      {"monotone in price", {{4, kU, 1}, {5, kU, -1}}, 0.1},
      {"fill before the evening", {{5, kU, 1}}, 1},
  };
  ConstraintLayer layer(rows, 6);
  Eigen::MatrixXd corrected;
  EXPECT_THAT([&] { layer.forward(Eigen::MatrixXd::Zero(kActionCount, 6), corrected); },
              ThrowsMessage<UserError>(Names(
                  "\"never charge when dear\" \"monotone in price\" \"fill before the evening\" "
                  "4")));
}

TEST(ConstraintLayer, BadRowsAreRefused) {
  const auto refusal = [](const DifferenceRow& row) {
    return [row] { ConstraintLayer({row}, 3); };
  };
  EXPECT_THAT(refusal({"far", {{3, kU, 1}}, 0}), ThrowsMessage<UserError>(Names("\"far\" 3")));
  EXPECT_THAT(refusal({"empty", {}, 0}), ThrowsMessage<UserError>(Names("\"empty\"")));
  EXPECT_THAT(refusal({"endless", {{0, kU, 1}}, std::numeric_limits<double>::infinity()}),
              ThrowsMessage<UserError>(Names("\"endless\"")));
  EXPECT_THAT(refusal({"nothing", {{0, kU, std::nan("")}}, 0}),
              ThrowsMessage<UserError>(Names("\"nothing\"")));
}

constexpr int kDis = static_cast<int>(Action::kDischarge);
constexpr int kIdle = static_cast<int>(Action::kIdle);
constexpr int kCha = static_cast<int>(Action::kCharge);

/// All promises of the header, on every cell.
void expect_properties(const CorrectionOptions& options, const LatticeAxes& axes,
                       const Eigen::MatrixXd& z) {
  constexpr double kTiny = 1e-9;
  const int prices = static_cast<int>(axes.price_eur_per_mwh.size());
  const int socs = static_cast<int>(axes.soc.size());
  const auto u = [&](int i, int j) { return z(kCha, i * socs + j) - z(kIdle, i * socs + j); };
  const auto v = [&](int i, int j) { return z(kIdle, i * socs + j) - z(kDis, i * socs + j); };
  const auto action = [&](int i, int j) { return argmax_action(z.col(i * socs + j).data()); };
  for (int i = 0; i < prices; ++i) {
    for (int j = 0; j < socs; ++j) {
      if (i + 1 < prices) {
        const double fall =
            options.price_slope * (axes.mapped_price[i + 1] - axes.mapped_price[i]) - kTiny;
        EXPECT_GE(u(i, j) - u(i + 1, j), fall);
        EXPECT_GE(v(i, j) - v(i + 1, j), fall);
        EXPECT_GE(action(i, j), action(i + 1, j));
      }
      if (j + 1 < socs) {
        const double fall = options.soc_slope * (axes.soc[j + 1] - axes.soc[j]) - kTiny;
        EXPECT_GE(u(i, j) - u(i, j + 1), fall);
        EXPECT_GE(v(i, j) - v(i, j + 1), fall);
        EXPECT_GE(action(i, j), action(i, j + 1));
      }
      if (axes.price_eur_per_mwh[i] <= options.thresholds.low_eur_per_mwh) {
        EXPECT_GE(u(i, j), options.logit_margin - kTiny);
        EXPECT_GE(v(i, j), -kTiny);
        EXPECT_EQ(action(i, j), Action::kCharge);
      }
      if (axes.price_eur_per_mwh[i] >= options.thresholds.high_eur_per_mwh) {
        EXPECT_LE(v(i, j), -options.logit_margin + kTiny);
        EXPECT_LE(u(i, j), kTiny);
        EXPECT_EQ(action(i, j), Action::kDischarge);
      }
    }
  }
}

TEST(CorrectionLayer, OutputHasTheProperties) {
  Random random(201);
  for (const LayerCase& c : kLayerCases) {
    SCOPED_TRACE(c.name);
    const LatticeAxes axes = even_axes(c.prices, c.socs);
    // One SoC price row cannot be bound from both ends; even_axes(1) holds only -500.
    CorrectionLayer layer(c.options, c.prices, c.socs);
    for (const double spread : {0.1, 1.0, 20.0}) {
      const Eigen::MatrixXd logits = random_logits(c.prices * c.socs, random, spread);
      Eigen::MatrixXd corrected;
      layer.forward(axes, logits, corrected);
      expect_properties(c.options, axes, corrected);
      const Eigen::RowVectorXd moved = corrected.colwise().mean() - logits.colwise().mean();
      EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1e-12 * (1 + spread)) << "the mean passes through";
    }
  }
}

}  // namespace
}  // namespace bess
