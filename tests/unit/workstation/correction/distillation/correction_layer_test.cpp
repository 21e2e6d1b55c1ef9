#include "workstation/correction/distillation/correction_layer.h"

#include <gtest/gtest.h>

#include "shared/action.h"
#include "tests/support/correction_cases.h"

namespace bess {
namespace {

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
