// Ruled policy: the nearest allowed action, nothing else changed, and its money counted.
#include "workstation/correction/rules/ruled_policy.h"
#include "tests/support/carried_over.h"

#include <gtest/gtest.h>

#include "tests/support/rule_sets.h"
#include "tests/support/small_market.h"

namespace bess {
namespace {

/// Charges below, discharges above, never idles between: much to forbid.
std::shared_ptr<Policy> restless() { return std::make_shared<RuleBasedPolicy>(99.5, 99.5); }

Evaluation run(Policy& policy) {
  return evaluate(small_steps(), small_steps().days_of(Split::kHeldOut), policy, kCarriedOver);
}

TEST(RuledPolicy, ObeysEveryRuleInEveryDecision) {
  const RuleSet rules = example_rules();
  const ContextClasses by_month;
  const auto ruled = std::make_shared<RuledPolicy>(restless(), rules, by_month);
  RuleWatch obedient(ruled, rules, by_month, 2, 1);
  RuleWatch free(restless(), rules, by_month, 2, 1);
  run(obedient);
  run(free);
  std::int64_t broken = 0;
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    EXPECT_EQ(obedient.counts()[r].visited_broken, 0) << rules.rules[r].name;
    EXPECT_EQ(obedient.counts()[r].drawn_broken, 0) << rules.rules[r].name;
    broken += free.counts()[r].drawn_broken;
  }
  EXPECT_GT(broken, 0);
  EXPECT_GT(ruled->changed_share(), 0);
  EXPECT_LT(ruled->changed_share(), 1);
}

TEST(RuledPolicy, WithoutARuleThatHoldsItIsTheSamePolicy) {
  const RuleSet rules = one_rule("price_min = 1400\nat_most = \"idle\"\nenforce = true");
  RuledPolicy ruled(restless(), rules, {});
  const std::shared_ptr<Policy> free = restless();
  const Evaluation with = run(ruled);
  const Evaluation without = run(*free);
  EXPECT_EQ(paired_difference(with, without).mean, 0);
  EXPECT_EQ(ruled.changed_share(), 0);
}

TEST(RuledPolicy, APowerCapHalvesTheEnergyOfAStep) {
  const RuleSet rules = one_rule("power_max = 0.5\nenforce = true");
  RuledPolicy ruled(restless(), rules, {});
  std::vector<StepRecord> steps;
  evaluate(small_steps(), small_steps().days_of(Split::kTest), ruled, kCarriedOver, &steps);
  const double most_w = BatteryParameters{}.power_w_max / 2;
  double largest_w = 0;
  for (const StepRecord& step : steps) largest_w = std::max(largest_w, std::fabs(step.power_w));
  EXPECT_EQ(largest_w, most_w);
  EXPECT_EQ(ruled.changed_share(), 0) << "the action is the same";
}

TEST(RuledPolicy, OnlyDemandsOnSingleStatesAreProjected) {
  EXPECT_TRUE(can_be_projected(one_rule("is = \"idle\"").rules[0]));
  EXPECT_TRUE(can_be_projected(one_rule("power_max = 0.5\nenforce = true").rules[0]));
  EXPECT_FALSE(can_be_projected(one_rule("never_rises_with = \"minute\"").rules[0]));
}

/// Rises with price: violates property 3 in the pairs around its threshold, and property 1.
class Backwards final : public Policy {
 public:
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double) const override {
    return step.observed_eur_per_mwh > 100 ? Action::kCharge : Action::kDischarge;
  }
};

TEST(RuleWatch, CountsViolationsOfAFloatPolicy) {
  const RuleSet all = with_properties(one_rule("price_max = 50\nat_least = \"idle\""), {50, 1500});
  RuleWatch watch(std::make_shared<Backwards>(), all, {}, 1, 1);
  run(watch);
  const auto& counts = watch.counts();
  ASSERT_EQ(counts.size(), 5U) << "properties 1 and 2, two directions, the rule";
  EXPECT_GT(counts[0].visited, 0);
  EXPECT_EQ(counts[0].visited_broken, counts[0].visited) << "it never charges below 50";
  EXPECT_GT(counts[2].visited_broken, 0) << "rises with price";
  EXPECT_LT(counts[2].visited_broken, counts[2].visited / 20);
  EXPECT_EQ(counts[3].visited_broken, 0) << "does not see the SoC";
  EXPECT_EQ(counts[4].visited_broken, counts[4].visited);
  EXPECT_EQ(counts[4].drawn_broken, counts[4].drawn);
  EXPECT_EQ(counts[2].visited, watch.decisions());
}

}  // namespace
}  // namespace bess
