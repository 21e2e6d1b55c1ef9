// Decision rule: its box and the remaining decisions, the integers that proof and guard share.
#include "shared/decision_rule.h"

#include <gtest/gtest.h>

#include <vector>

#include "shared/features.h"

namespace bess {
namespace {

constexpr ActionSet kNoCharge = action_bit(Action::kDischarge) | action_bit(Action::kIdle);
constexpr ActionSet kNoIdle = action_bit(Action::kDischarge) | action_bit(Action::kCharge);

TEST(NearestAllowed, IsItselfTheNearestOrTheLower) {
  EXPECT_EQ(nearest_allowed(kAllActions, Action::kIdle), Action::kIdle);
  EXPECT_EQ(nearest_allowed(kNoCharge, Action::kCharge), Action::kIdle);
  EXPECT_EQ(nearest_allowed(kNoIdle, Action::kIdle), Action::kDischarge);
  EXPECT_EQ(nearest_allowed(action_bit(Action::kCharge), Action::kDischarge), Action::kCharge);
  EXPECT_EQ(nearest_allowed(0, Action::kCharge), Action::kIdle) << "nothing is allowed";
}

struct PointCase {
  const char* name;
  RulePoint point;
  bool inside;
};

TEST(RuleBox, HoldsItsEndsAndNothingBeyond) {
  // 22:00 to 01:30, past midnight; November to January; 10 to 30 %; -50 to 300.
  const RuleBox box{-50, 300, 20, 60, 88, 14, 1 << 10 | 1 << 11 | 1, 1 << 2};
  const PointCase cases[] = {
      {"inside", {0, 40, 90, 12, 3}, true},
      {"lowest price", {-50, 40, 90, 12, 3}, true},
      {"below", {-51, 40, 90, 12, 3}, false},
      {"highest price", {300, 40, 90, 12, 3}, true},
      {"above", {301, 40, 90, 12, 3}, false},
      {"lowest SoC", {0, 20, 90, 12, 3}, true},
      {"emptier", {0, 19, 90, 12, 3}, false},
      {"highest SoC", {0, 60, 90, 12, 3}, true},
      {"fuller", {0, 61, 90, 12, 3}, false},
      {"first quarter-hour", {0, 40, 88, 12, 3}, true},
      {"before", {0, 40, 87, 12, 3}, false},
      {"last before midnight", {0, 40, 95, 12, 3}, true},
      {"first after midnight", {0, 40, 0, 12, 3}, true},
      {"last", {0, 40, 5, 12, 3}, true},
      {"after", {0, 40, 6, 12, 3}, false},
      {"January", {0, 40, 90, 1, 3}, true},
      {"February", {0, 40, 90, 2, 3}, false},
      {"another class", {0, 40, 90, 12, 4}, false},
  };
  for (const PointCase& c : cases) EXPECT_EQ(box.contains(c.point), c.inside) << c.name;
  for (int hour = 0; hour < kQuarterHourCount; ++hour) {
    EXPECT_TRUE(RuleBox{}.contains({0, 0, static_cast<std::int16_t>(hour), 1, 1})) << hour;
  }
}

TEST(WholePrice, IsTheLatticePriceWithoutItsEnds) {
  for (std::int32_t centi = -60'000; centi <= 170'000; centi += 7) {
    const std::int32_t whole = whole_price_of(centi);
    if (centi < kLatticePriceMinEurPerMwh * kCentiPerEur) {
      EXPECT_LE(whole, kLatticePriceMinEurPerMwh);
    } else if (centi > kLatticePriceMaxEurPerMwh * kCentiPerEur) {
      EXPECT_GE(whole, kLatticePriceMaxEurPerMwh);
    } else {
      ASSERT_EQ(whole, lattice_price_of(centi)) << centi;
    }
  }
  EXPECT_EQ(whole_price_of(-1'500'000), -15'000);
  EXPECT_EQ(whole_price_of(2'590'754), 15'000) << "beyond every end of a rule";
  EXPECT_EQ(whole_price_of(-9'999'900), -15'000);
}

TEST(RuleLimits, AllRulesCountWhereTheyHold) {
  const std::vector<GuardRule> rules{
      {{.price_min_eur_per_mwh = 300}, {kNoCharge, 1000}},
      {{.soc_index_max = 60}, {kNoIdle, 700}},
      {{.price_min_eur_per_mwh = 200}, {kAllActions, 500}},
  };
  EXPECT_EQ(rule_limits_at(rules, {100, 100, 0, 1, 1}), RuleLimits{});
  EXPECT_EQ(rule_limits_at(rules, {250, 100, 0, 1, 1}), (RuleLimits{kAllActions, 500}));
  EXPECT_EQ(rule_limits_at(rules, {100, 60, 0, 1, 1}), (RuleLimits{kNoIdle, 700}));
  EXPECT_EQ(rule_limits_at(rules, {300, 60, 0, 1, 1}),
            (RuleLimits{action_bit(Action::kDischarge), 500}));
}

TEST(RuledHash, KnowsEveryRowAndField) {
  const std::int32_t row[kGuardRuleFields] = {-100, 400, 3, 150, 92, 28, 0x803, 0xfff, 2, 500};
  const std::vector<GuardRule> rules{guard_rule_of(row),
                                     {{.price_min_eur_per_mwh = 301}, {kNoCharge, 1000}}};
  const std::uint32_t hash = ruled_hash(0x12345678, rules);
  EXPECT_EQ(ruled_hash(0x12345678, std::vector<GuardRule>{}), 0x12345678U) << "as without rules";
  EXPECT_NE(ruled_hash(0x12345679, rules), hash);
  EXPECT_NE(ruled_hash(0x12345678, std::vector{rules[0]}), hash);
  EXPECT_NE(ruled_hash(0x12345678, std::vector{rules[1]}), hash);
  EXPECT_NE(ruled_hash(0x12345678, std::vector{rules[1], rules[0]}), hash);
  for (int field = 0; field < kGuardRuleFields; ++field) {
    std::int32_t other[kGuardRuleFields];
    std::copy(std::begin(row), std::end(row), other);
    ++other[field];
    EXPECT_NE(ruled_hash(0x12345678, std::vector{guard_rule_of(other), rules[1]}), hash) << field;
  }
}

}  // namespace
}  // namespace bess
