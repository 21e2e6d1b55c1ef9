// Rules that cannot be obeyed together are refused, naming them and one state; what rules imply beyond their boxes
// is what brute force over all monotone ways says.
#include "workstation/rules/rule_conflicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/rule_sets.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string named(const std::string& name, const std::string& lines) {
  return "[[rule]]\nname = \"" + name + "\"\n" + lines + "\n";
}

std::string complaint(const std::string& text, ContextKind kind = ContextKind::kLevel,
                      const PriceThresholds& thresholds = {}) {
  try {
    require_consistent(parse_rules(text, "test.toml"), thresholds, kind);
  } catch (const UserError& error) {
    return error.what();
  }
  return "consistent";
}

TEST(Conflicts, TheExamplesCanBeObeyedTogether) {
  EXPECT_NO_THROW(require_consistent(example_rules(), {}, ContextKind::kLevel));
  EXPECT_NO_THROW(require_consistent(example_rules(), {}, ContextKind::kMonth));
}

TEST(Conflicts, BothRulesAndAStateAreNamed) {
  const std::string text =
      complaint(named("always charge", "soc_max = 0.2\nprice_max = 50\nis = \"charge\"") +
                named("night", "hours = \"01:00-02:00\"\nis = \"idle\""));
  EXPECT_THAT(text, AllOf(HasSubstr("test.toml:1: \"always charge\""),
                          HasSubstr("contradicts \"night\" (test.toml:6)"), HasSubstr("01:00"),
                          HasSubstr("narrow or drop one of them")));
}

/// "At least" reaches down to lower prices and charges, "at most" up: boxes far apart may clash.
TEST(Conflicts, WhatIsImpliedClashesToo) {
  const std::string dear =
      named("dear", "price_min = 200\nprice_max = 300\nsoc_min = 0.6\nat_least = \"idle\"");
  EXPECT_THAT(
      complaint(dear + named("cheap", "price_max = 100\nsoc_max = 0.5\nis = \"discharge\"")),
      HasSubstr("\"dear\" contradicts \"cheap\""));
  EXPECT_EQ(complaint(dear + named("dearer", "price_min = 301\nis = \"discharge\"")), "consistent");
  EXPECT_EQ(complaint(dear + named("low", "soc_max = 0.5\nprice_max = 100\nat_least = \"idle\"")),
            "consistent");
  EXPECT_EQ(complaint(named("a", "hours = \"01:00-02:00\"\nis = \"charge\"\nprice_max = 100") +
                      named("b", "hours = \"02:00-03:00\"\nis = \"discharge\"\nprice_min = 0")),
            "consistent");
  EXPECT_EQ(complaint(named("a", "context_classes = [1]\nis = \"charge\"\nprice_max = 100") +
                      named("b", "context_classes = [2]\nis = \"discharge\"\nprice_min = 0")),
            "consistent");
  EXPECT_THAT(complaint(named("a", "context_classes = [1]\nis = \"charge\"\nprice_max = 100") +
                        named("b", "context_classes = [2]\nis = \"discharge\"\nprice_min = 0") +
                        named("c", "never_falls_with = \"context_class\"")),
              HasSubstr("\"a\" contradicts \"b\""));
}

TEST(Conflicts, TheThresholdsCount) {
  EXPECT_THAT(complaint(named("never sell", "at_least = \"idle\"")),
              HasSubstr("\"never sell\" contradicts \"[correction] high_price_eur_per_mwh\""));
  EXPECT_EQ(complaint(named("never sell", "at_least = \"idle\"") +
                      named("no threshold", "discharge_at_or_above = 2000")),
            "consistent");
  EXPECT_EQ(
      complaint(named("never sell", "at_least = \"idle\""), ContextKind::kLevel, {-500, 1501}),
      "consistent");
  EXPECT_THAT(complaint(named("t", "charge_at_or_below = 1500")), HasSubstr("cross"));
}

TEST(Conflicts, NotIdleBetweenTwoThatLeaveOnlyThat) {
  const std::string least = named("least", "price_max = 100\nat_least = \"idle\"");
  const std::string most = named("most", "price_min = 50\nat_most = \"idle\"");
  const std::string gap = named("gap", "price_min = 80\nprice_max = 120\nis_not = \"idle\"");
  EXPECT_EQ(complaint(least + most), "consistent");
  EXPECT_THAT(complaint(least + most + gap),
              AllOf(HasSubstr("\"gap\" contradicts"), HasSubstr("80 EUR/MWh")));
  EXPECT_EQ(complaint(least + gap), "consistent");
}

TEST(Conflicts, WhatTheGuardEnforcesIsHeldAgainstTheBareBoxes) {
  const std::string far = "price_min = 2000\nprice_max = 3000\nis = \"charge\"\nenforce = true";
  EXPECT_THAT(
      complaint(named("a", far) + named("b", "price_min = 2500\nis = \"idle\"\nenforce = true")),
      AllOf(HasSubstr("\"a\" contradicts \"b\""), HasSubstr("2500 EUR/MWh")));
  EXPECT_EQ(
      complaint(named("a", far) + named("b", "price_min = 3001\nis = \"idle\"\nenforce = true")),
      "consistent");
}

TEST(Conflicts, ARuleThatBindsNobodyIsRefused) {
  EXPECT_THAT(complaint(named("far", "price_min = 2000\nis = \"idle\"")),
              HasSubstr("binds nobody: no price of it lies on the lattice; add enforce = true"));
  EXPECT_THAT(
      complaint(named("winter", "months = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\"")),
      HasSubstr("does not see months"));
  EXPECT_EQ(complaint(named("winter", "months = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\""),
                      ContextKind::kMonth),
            "consistent");
  EXPECT_THAT(
      complaint(named("c", "context_classes = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\""),
                ContextKind::kMonth),
      HasSubstr("the student is by month"));
}

TEST(Conflicts, OppositeDirectionsAreRefused) {
  EXPECT_THAT(complaint(named("up", "never_falls_with = \"context_class\"") +
                        named("down", "never_rises_with = \"context_class\"")),
              HasSubstr("\"up\" contradicts \"down\""));
}

/// Straight from the definition: a state's range is bound by every rule whose box holds a comparable state.
TEST(ImpliedRanges, AreWhatComparableStatesSay) {
  const RuleSet set = parse_rules(
      named("a",
            "price_min = 40\nprice_max = 90\nsoc_min = 0.2\nsoc_max = 0.4\nat_least = \"idle\"") +
          named("b", "price_min = 60\nsoc_min = 0.7\nat_most = \"idle\"\nhours = \"03:00-05:00\"") +
          named("c", "price_max = -200\nsoc_max = 0.5\nis = \"charge\"") +
          named("d", "price_min = -50\nprice_max = 30\nis_not = \"idle\""),
      "test.toml");
  const ImpliedRanges implied(set, ContextKind::kLevel);
  Random random(11);
  for (int n = 0; n < 20'000; ++n) {
    const auto price = -500 + static_cast<int>(random.index(2001));
    const auto soc = static_cast<int>(random.index(kSocCount));
    const auto hour = static_cast<int>(random.index(kQuarterHourCount));
    ActionRange expected;
    if (price <= 90 && soc <= 80) expected.lowest = Action::kIdle;
    if (price <= -200 && soc <= 100) expected.lowest = Action::kCharge;
    if (price >= 60 && soc >= 140 && hour >= 12 && hour < 20) expected.highest = Action::kIdle;
    expected.has_gap = price >= -50 && price <= 30;
    const ActionRange found = implied.at(hour, 1 + n % 12, soc, price);
    ASSERT_EQ(found.lowest, expected.lowest) << price << ' ' << soc << ' ' << hour;
    ASSERT_EQ(found.highest, expected.highest) << price << ' ' << soc << ' ' << hour;
    ASSERT_EQ(found.has_gap, expected.has_gap) << price;
  }
}

}  // namespace
}  // namespace bess
