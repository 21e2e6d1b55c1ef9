// Rules through the optimisation layer: rows of one lattice, and a student that learns them.

#include <gtest/gtest.h>

#include <set>

#include "shared/action.h"
#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"
#include "tests/support/teachers.h"
#include "workstation/correction/distillation/constraint_layer.h"
#include "workstation/correction/distillation/distil.h"

namespace bess {
namespace {

LatticeAxes lattice_axes(const std::vector<int>& prices, const std::vector<int>& soc_indices) {
  LatticeAxes axes;
  for (const int price : prices) {
    axes.price_eur_per_mwh.push_back(price);
    axes.mapped_price.push_back((price - kLatticePriceMinEurPerMwh) / double{kPriceCount - 1});
  }
  for (const int soc : soc_indices) axes.soc.push_back(double{scaled_input(soc, kSocScale)});
  return axes;
}

CorrectionOptions margin_of(double logit_margin) {
  CorrectionOptions options;
  options.logit_margin = logit_margin;
  return options;
}

constexpr const char* kReserve =
    "hours = \"17:00-20:00\"\nsoc_max = 0.3\nprice_min = 0\nprice_max = 300\nat_least = \"idle\"";

/// Every state of the lattice is in the box or not, ends included.
TEST(LatticeRows, StatesOfTheBoxAndNoOthers) {
  const RuleSet rules = one_rule(kReserve, "reserve");
  const LatticeAxes axes = lattice_axes({-1, 0, 300, 301}, {0, 59, 60, 61, 200});
  LatticeState context{};
  context.quarter_hour = 17 * 4;
  context.context_class = 3;
  const auto rows = lattice_rows(rules, ContextKind::kMonth, context, axes, margin_of(0.5));
  std::set<int> states;
  for (const DifferenceRow& row : rows) {
    EXPECT_EQ(row.rule, "reserve");
    ASSERT_EQ(row.terms.size(), 1U);
    EXPECT_EQ(row.terms[0].difference, Difference::kV);
    EXPECT_EQ(row.terms[0].factor, 1);
    EXPECT_EQ(row.bound, 0.5);
    states.insert(row.terms[0].state);
  }
  EXPECT_EQ(states, (std::set<int>{5, 6, 7, 10, 11, 12})) << "0 and 300 EUR/MWh, up to index 60";
  context.quarter_hour = 20 * 4;
  EXPECT_TRUE(lattice_rows(rules, ContextKind::kMonth, context, axes, margin_of(0.5)).empty());
}

TEST(LatticeRows, TheCorrectedActionsObey) {
  const RuleSet rules = example_rules();
  Random random(17);
  const LatticeAxes axes = lattice_axes({-500, -80, 0, 40, 99, 150, 300, 301, 400, 999, 1500},
                                        {0, 30, 60, 61, 120, 200});
  int bound = 0;
  for (int quarter_hour = 0; quarter_hour < kQuarterHourCount; quarter_hour += 3) {
    LatticeState context{};
    context.quarter_hour = static_cast<std::int16_t>(quarter_hour);
    context.context_class = static_cast<std::int16_t>(1 + random.index(12));
    std::vector<DifferenceRow> rows =
        lattice_rows(rules, ContextKind::kMonth, context, axes, margin_of(0.5));
    bound += rows.empty() ? 0 : 1;
    const auto properties = property_rows({}, axes);
    rows.insert(rows.end(), properties.begin(), properties.end());
    ConstraintLayer layer(rows, 66);
    Eigen::MatrixXd logits(kActionCount, 66);
    for (double& z : logits.reshaped()) z = 3 * random.normal();
    Eigen::MatrixXd corrected;
    layer.forward(logits, corrected);
    for (int c = 0; c < 66; ++c) {
      const Action action = argmax_action(corrected.col(c).data());
      const auto soc =
          std::lround(axes.soc[static_cast<std::size_t>(c % 6)] * kInputOne / kSocScale);
      for (const Rule& rule : rules.rules) {
        const RulePoint point{axes.price_eur_per_mwh[static_cast<std::size_t>(c / 6)],
                              static_cast<std::int16_t>(soc), context.quarter_hour,
                              context.context_class, context.context_class};
        if (!rule.box.contains(point)) continue;
        EXPECT_TRUE(allows(rule.actions(), action)) << rule.name << ", state " << c;
      }
    }
  }
  EXPECT_GT(bound, 5);
}

/// Through the layer alone a student learns to keep a rule that its teacher breaks.
TEST(LatticeRows, AStudentLearnsARule) {
  const Teacher teacher =
      network_teacher(Method::kDqn, {-30, 30, 11}, PriceMap(even_price_table()), 7);
  Random random(8);
  Matrix visited(kNetworkInputs, 300);
  const auto write = [&](const LatticeState& s, float* x) {
    write_input(network_context(s.minute_of_quarter_hour, s.quarter_hour, s.context_class,
                                teacher.price_map(s.price_eur_per_mwh)),
                0, x);
    x[3] = scaled_input(s.soc_index, kSocScale);
  };
  for (int c = 0; c < 300; ++c) write(random_state(random), visited.col(c).data());
  DistilOptions options;
  options.method = CorrectionMethod::kLayer;
  options.steps_per_epoch = 4;
  options.lattices_per_epoch = 4;
  options.lattice_prices = 8;
  options.lattice_socs = 6;
  options.visited_per_epoch = 256;
  options.rules = one_rule("price_min = -300\nprice_max = 1200\nis = \"idle\"");
  options.correction.logit_margin = 0.5;
  const std::atomic<bool> goes_on{false};
  Distiller distiller(teacher, visited, options);
  distiller.run(60, {}, 1, goes_on);
  const ConstMlp student(kStudentShape, distiller.parameters().data());
  int kept = 0;
  constexpr int kStates = 500;
  Matrix x(kNetworkInputs, kStates);
  for (int c = 0; c < kStates; ++c) {
    LatticeState s = random_state(random);
    s.price_eur_per_mwh = static_cast<std::int16_t>(-250 + static_cast<int>(random.index(1401)));
    write(s, x.col(c).data());
  }
  MlpTile tile;
  Matrix z;
  forward_hidden(student, x, tile);
  forward_head(student, tile, z);
  for (int c = 0; c < kStates; ++c) kept += argmax_action(z.col(c).data()) == Action::kIdle ? 1 : 0;
  EXPECT_GT(kept, 0.95 * kStates);
}

}  // namespace
}  // namespace bess
