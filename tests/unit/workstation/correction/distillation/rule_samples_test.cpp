// Rules in the distillation: rows that imply the allowed actions, corners that decide a box,
// training states that obey.
#include "workstation/correction/distillation/monotone_distil.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"
#include "workstation/correction/distillation/constraint_layer.h"
#include "workstation/correction/student/certificate.h"

namespace bess {
namespace {

/// Any scores that satisfy the rows have an allowed action, and every set but "all" demands
/// something.
TEST(ScoreRows, ImplyTheActions) {
  Random random(3);
  for (ActionSet set = 1; set <= kAllActions; ++set) {
    int kept = 0;
    for (int n = 0; n < 20'000; ++n) {
      const double u = 6 * random.uniform() - 3;
      const double v = 6 * random.uniform() - 3;
      bool keeps = true;
      for (const ScoreRow& row : ScoreRows(set, u, v, 0.5)) {
        keeps = keeps && row.on_u * u + row.on_v * v >= row.at_least;
      }
      if (!keeps) continue;
      ++kept;
      const double logits[] = {-v, 0, u};
      ASSERT_TRUE(allows(set, argmax_action(logits))) << int{set} << ' ' << u << ' ' << v;
    }
    EXPECT_GT(kept, 100) << int{set};
    EXPECT_EQ(kept == 20'000, set == kAllActions) << int{set};
  }
}

/// A monotone student that satisfies the corners of a rule satisfies its whole box; omitted corners
/// show.
TEST(RuleSamples, CornersDecideABoxOfAMonotoneStudent) {
  const RuleSet rules = parse_rules(
      "[[rule]]\nname = \"a\"\nprice_min = 0\nprice_max = 300\nsoc_max = 0.5\nat_least = \"idle\"\n"
      "[[rule]]\nname = \"b\"\nprice_min = 700\nsoc_min = 0.2\nat_most = \"idle\"\nhours = "
      "\"00:00-12:00\"\n"
      "[[rule]]\nname = \"c\"\nprice_min = 400\nprice_max = 600\nis = \"idle\"\n",
      "test.toml");
  const RuleSamples samples(rules, ContextKind::kMonth);
  ASSERT_EQ(samples.count(), 3U);
  std::set<bool> verdicts;
  for (int charge_below = 1000; charge_below <= 12'000; charge_below += 500) {
    for (int gap = 0; gap <= 8000; gap += 1000) {
      const StudentNet net =
          LinearNet{
              .soc_weight = 0, .charge_below = charge_below, .discharge_from = charge_below + gap}
              .net();
      const LatticeState context = context_at(0);
      std::vector<ConstraintState> corners;
      samples.corners(context, corners);
      ASSERT_EQ(corners.size(), 4U);
      bool keeps = true;
      for (const ConstraintState& c : corners)
        keeps = keeps && allows(c.actions, net.decide(c.state));
      const Certificate found =
          verify_student(net, {.rules = rules, .context_stride = kContextCount, .threads = 1});
      std::int64_t violations = 0;
      for (const RuleCount& count : found.rule_counts()) violations += count.violations;
      EXPECT_EQ(keeps, violations == 0) << charge_below << ' ' << gap;
      verdicts.insert(keeps);
    }
  }
  EXPECT_EQ(verdicts.size(), 2U) << "some keep the rules and some do not";
  std::vector<ConstraintState> corners;
  samples.corners(context_at(60 * kMinuteOfQuarterHourCount), corners);
  EXPECT_EQ(corners.size(), 3U) << "b does not hold in the afternoon";
}

TEST(RuleSamples, StatesAreDrawnInTheBoxAndFromCounterexamples) {
  const RuleSet rules = one_rule(
      "hours = \"23:00-01:00\"\nmonths = [2, 12]\nprice_min = 10\nprice_max = 20\nsoc_min = 0.5\n"
      "is_not = \"idle\"");
  const RuleSamples samples(rules, ContextKind::kMonth);
  Random random(9);
  std::set<int> hours, months, prices;
  for (int n = 0; n < 3000; ++n) {
    const ConstraintState drawn = samples.draw(0, {}, random);
    const LatticeState& s = drawn.state;
    const RulePoint point{s.price_eur_per_mwh, s.soc_index, s.quarter_hour, s.context_class,
                          s.context_class};
    ASSERT_TRUE(rules.rules[0].box.contains(point));
    hours.insert(s.quarter_hour);
    months.insert(s.context_class);
    prices.insert(s.price_eur_per_mwh);
  }
  EXPECT_EQ(hours.size(), 8U);
  EXPECT_EQ(months, (std::set<int>{2, 12}));
  EXPECT_EQ(prices.size(), 11U);
  int at_known = 0;
  const std::vector<LatticeState> known{{7, 94, 12, 0, 0}, {7, 50, 12, 0, 0}};
  for (int n = 0; n < 1000; ++n) {
    const LatticeState s = samples.draw(0, known, random).state;
    EXPECT_NE(s.quarter_hour, 50) << "outside the rule's hours";
    at_known += s.minute_of_quarter_hour == 7 && s.quarter_hour == 94 ? 1 : 0;
  }
  EXPECT_GT(at_known, 200);
}

TEST(RuleSamples, ActionsAtAnInputAreThoseOfItsLatticeState) {
  const RuleSet rules = example_rules();
  const RuleSamples samples(rules, ContextKind::kMonth);
  const ImpliedRanges implied(rules, ContextKind::kMonth);
  const PriceMap map(even_price_table());
  Random random(4);
  int bound = 0;
  for (int n = 0; n < 5000; ++n) {
    const LatticeState s = random_state(random);
    float x[kNetworkInputs];
    write_input(network_context(s.minute_of_quarter_hour, s.quarter_hour, s.context_class,
                                map(s.price_eur_per_mwh)),
                0, x);
    x[3] = scaled_input(s.soc_index, kSocScale);
    const ActionSet expected =
        implied.at(s.quarter_hour, s.context_class, s.soc_index, s.price_eur_per_mwh);
    ASSERT_EQ(samples.actions_at(x, map), expected);
    bound += expected == kAllActions ? 0 : 1;
  }
  EXPECT_GT(bound, 1000);
}

}  // namespace
}  // namespace bess
