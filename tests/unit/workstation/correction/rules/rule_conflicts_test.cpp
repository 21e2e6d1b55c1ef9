// Contradictory rules are refused, naming them and one state; the consequences of rules beyond
// their boxes equal brute force over all monotone policies.
#include "workstation/correction/rules/rule_conflicts.h"

#include <gmock/gmock.h>

#include <bit>

#include "tests/support/rule_sets.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

std::string named(const std::string& name, const std::string& lines) {
  return "[[rule]]\nname = \"" + name + "\"\n" + lines + "\n";
}

/// Empty if the rules are consistent.
std::string complaint(const std::string& text, ContextKind kind = ContextKind::kLevel,
                      const PriceThresholds& thresholds = {}) {
  return refusal_of([&] { require_consistent(parse_rules(text, "test.toml"), thresholds, kind); });
}

TEST(Conflicts, BothRulesAndAStateAreNamed) {
  const std::string text =
      complaint(named("always charge", "soc_max = 0.2\nprice_max = 50\nis = \"charge\"") +
                named("night", "hours = \"01:00-02:00\"\nis = \"idle\""));
  EXPECT_THAT(text, Names("test.toml:1 \"always charge\" \"night\" test.toml:6 01:00"));
}

/// "At least" extends to lower prices and charges, "at most" to higher ones: distant boxes may
/// conflict.
TEST(Conflicts, ImpliedDemandsConflictToo) {
  const std::string dear =
      named("dear", "price_min = 200\nprice_max = 300\nsoc_min = 0.6\nat_least = \"idle\"");
  EXPECT_THAT(
      complaint(dear + named("cheap", "price_max = 100\nsoc_max = 0.5\nis = \"discharge\"")),
      Names("\"dear\" \"cheap\""));
  EXPECT_EQ(complaint(dear + named("dearer", "price_min = 301\nis = \"discharge\"")), "");
  EXPECT_EQ(complaint(dear + named("low", "soc_max = 0.5\nprice_max = 100\nat_least = \"idle\"")),
            "");
  EXPECT_EQ(complaint(named("a", "hours = \"01:00-02:00\"\nis = \"charge\"\nprice_max = 100") +
                      named("b", "hours = \"02:00-03:00\"\nis = \"discharge\"\nprice_min = 0")),
            "");
  EXPECT_EQ(complaint(named("a", "context_classes = [1]\nis = \"charge\"\nprice_max = 100") +
                      named("b", "context_classes = [2]\nis = \"discharge\"\nprice_min = 0")),
            "");
  EXPECT_THAT(complaint(named("a", "context_classes = [1]\nis = \"charge\"\nprice_max = 100") +
                        named("b", "context_classes = [2]\nis = \"discharge\"\nprice_min = 0") +
                        named("c", "never_falls_with = \"context_class\"")),
              Names("\"a\" \"b\""));
}

TEST(Conflicts, TheThresholdsCount) {
  EXPECT_THAT(complaint(named("never sell", "at_least = \"idle\"")),
              Names("\"never sell\" \"[correction] high_price_eur_per_mwh\""));
  EXPECT_EQ(complaint(named("never sell", "at_least = \"idle\"") +
                      named("no threshold", "discharge_at_or_above = 2000")),
            "");
  EXPECT_EQ(
      complaint(named("never sell", "at_least = \"idle\""), ContextKind::kLevel, {-500, 1501}), "");
  EXPECT_THAT(complaint(named("t", "charge_at_or_below = 1500")),
              Names("[correction] 1500 EUR/MWh"));
}

TEST(Conflicts, WhatTheGuardEnforcesIsHeldAgainstTheBareBoxes) {
  const std::string far = "price_min = 2000\nprice_max = 3000\nis = \"charge\"\nenforce = true";
  EXPECT_THAT(
      complaint(named("a", far) + named("b", "price_min = 2500\nis = \"idle\"\nenforce = true")),
      Names("\"a\" \"b\" 2500 EUR/MWh"));
  EXPECT_EQ(
      complaint(named("a", far) + named("b", "price_min = 3001\nis = \"idle\"\nenforce = true")),
      "");
}

TEST(Conflicts, ARuleWithoutEffectIsRefused) {
  EXPECT_THAT(complaint(named("far", "price_min = 2000\nis = \"idle\"")),
              Names("\"far\" enforce = true"));
  EXPECT_THAT(
      complaint(named("winter", "months = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\"")),
      Names("\"winter\""));
  EXPECT_EQ(complaint(named("winter", "months = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\""),
                      ContextKind::kMonth),
            "");
  EXPECT_THAT(
      complaint(named("c", "context_classes = [1]\nprice_min = 0\nprice_max = 9\nis = \"idle\""),
                ContextKind::kMonth),
      Names("\"c\""));
}

TEST(Conflicts, OppositeDirectionsAreRefused) {
  EXPECT_THAT(complaint(named("up", "never_falls_with = \"context_class\"") +
                        named("down", "never_rises_with = \"context_class\"")),
              Names("\"up\" \"down\""));
}

/// By definition: a state's range is bounded by every rule whose box holds a comparable state. Any
/// set is decided beforehand: those that pass have a policy, those that are refused have none.

/// Rules of few boxes, so that all states of a grid box below are equivalent.
class Cells {
 public:
  static constexpr int kPrices[] = {-500, -499, -100, 100,
                                    300,  1500, 1501};  ///< begins, and the end
  static constexpr int kSocs[] = {0, 50, 100, 201};
  static constexpr int kHours = 4;    ///< six hours each
  static constexpr int kClasses = 3;  ///< four classes each
  static constexpr int kPriceCells = std::size(kPrices) - 1;
  static constexpr int kSocCells = std::size(kSocs) - 1;

  explicit Cells(const RuleSet& rules) {
    for (const Rule& rule : rules.rules) {
      if (rule.demand->pairs_along()) continue;
      for (int at = 0; at < kCount; ++at) {
        if (rule.box.contains(point_of(at))) left_[at] = left_[at] & rule.actions();
      }
    }
    for (const Direction& direction : rules.directions()) {
      if (direction.input != RuleInput::kMinute) directions_.push_back(direction);
    }
  }

  /// Sets of a chain and its order: when no element can be removed any more, a selection exists.
  [[nodiscard]] bool have_a_policy() {
    for (bool changed = true; changed;) {
      changed = false;
      for (int at = 0; at < kCount; ++at) {
        for (const Direction& direction : directions_) {
          const int next = at + kStride[static_cast<int>(direction.input)];
          if (index_of(at, direction.input) + 1 == count_of(direction.input)) continue;
          const auto [low, high] = direction.sign < 0 ? std::pair(next, at)
                                                      : std::pair(at, next);  // action: low <= high
          changed = keep_at_most(low, highest(high)) || keep_at_least(high, lowest(low)) || changed;
        }
        if (left_[at] == 0) return false;
      }
    }
    return true;
  }

 private:
  static constexpr int kCount = kPriceCells * kSocCells * kHours * kClasses;
  /// By RuleInput; nothing depends on the minute.
  static constexpr int kStride[] = {0, kPriceCells* kSocCells, kPriceCells* kSocCells* kHours,
                                    kPriceCells, 1};
  static int count_of(RuleInput input) {
    constexpr int kCounts[] = {1, kHours, kClasses, kSocCells, kPriceCells};
    return kCounts[static_cast<int>(input)];
  }
  static int index_of(int at, RuleInput input) {
    return at / kStride[static_cast<int>(input)] % count_of(input);
  }
  static RulePoint point_of(int at) {
    return {
        .price_eur_per_mwh = kPrices[index_of(at, RuleInput::kPrice)],
        .soc_index = static_cast<std::int16_t>(kSocs[index_of(at, RuleInput::kSoc)]),
        .quarter_hour = static_cast<std::int16_t>(24 * index_of(at, RuleInput::kQuarterHour)),
        .month = 1,
        .context_class = static_cast<std::int16_t>(1 + 4 * index_of(at, RuleInput::kContextClass))};
  }
  [[nodiscard]] int lowest(int at) const { return std::countr_zero(unsigned{left_[at]}); }
  [[nodiscard]] int highest(int at) const {
    return static_cast<int>(std::bit_width(unsigned{left_[at]})) - 1;
  }
  bool keep(int at, unsigned actions) {
    const unsigned before = left_[at];
    left_[at] = static_cast<ActionSet>(before & actions);
    return left_[at] != before;
  }
  bool keep_at_most(int at, int action) { return keep(at, (1U << (action + 1)) - 1); }
  bool keep_at_least(int at, int action) { return keep(at, ~((1U << action) - 1)); }

  std::vector<ActionSet> left_ = std::vector<ActionSet>(kCount, kAllActions);
  std::vector<Direction> directions_;
};

Rule random_rule(Random& random, int number) {
  const auto one_of = [&random](auto... texts) {
    const char* const all[] = {texts...};
    return std::string(all[random.index(sizeof...(texts))]);
  };
  std::string lines =
      one_of("is = \"charge\"\n", "is = \"idle\"\n", "is = \"discharge\"\n", "is_not = \"idle\"\n",
             "at_least = \"idle\"\n", "at_most = \"idle\"\n", "is_not = \"idle\"\n",
             "never_falls_with = \"quarter_hour\"\n", "never_rises_with = \"context_class\"\n");
  if (!lines.starts_with("never")) {
    lines +=
        one_of("", "price_min = -100\n", "price_min = 100\nprice_max = 299\n", "price_min = 300\n",
               "price_max = 299\n", "price_max = 99\n", "price_min = 300\nprice_max = 1499\n");
    lines += one_of("", "soc_min = 0.25\n", "soc_max = 0.245\n", "soc_min = 0.5\n");
    lines += one_of("", "hours = \"00:00-06:00\"\n", "hours = \"12:00-18:00\"\n",
                    "hours = \"18:00-06:00\"\n");
    lines += one_of("", "", "context_classes = [1, 2, 3, 4]\n",
                    "context_classes = [5, 6, 7, 8, 9, 10, 11, 12]\n");
  }
  return one_rule(lines, "rule " + std::to_string(number)).rules[0];
}

TEST(Conflicts, ASetPassesIfAndOnlyIfSomePolicyObeysIt) {
  Random random(11);
  int passed = 0;
  constexpr int kSets = 3000;
  for (int n = 0; n < kSets; ++n) {
    RuleSet rules;
    for (int r = 0; r < 1 + n % 4; ++r) rules.rules.push_back(random_rule(random, r));
    RuleSet with_thresholds = rules;
    with_thresholds.rules.push_back(one_rule("charge_at_or_below = -500").rules[0]);
    with_thresholds.rules.push_back(one_rule("discharge_at_or_above = 1500").rules[0]);
    const std::string said = refusal_of([&] {
      require_consistent(rules, {-500, 1500}, ContextKind::kLevel);
    });
    const bool is_taken = said.empty();
    ASSERT_EQ(is_taken, Cells(with_thresholds).have_a_policy()) << said << '\n'
                                                                << format_rules(rules);
    passed += is_taken ? 1 : 0;
  }
  EXPECT_GT(passed, kSets / 10);
  EXPECT_LT(passed, kSets - kSets / 10);
}

TEST(Opposites, TheNearestIsNamedWithTheRoomThatItLeaves) {
  const RuleSet rules = parse_rules(
      named("buy", "price_max = 100\nhours = \"10:00-14:00\"\nis = \"charge\"") +
          named("sell", "price_min = 104\nhours = \"12:00-13:00\"\nis = \"discharge\"") +
          named("other hours", "price_min = 101\nhours = \"15:00-16:00\"\nis = \"discharge\"") +
          named("full",
                "soc_min = 0.6\nprice_min = 90\nhours = \"20:00-21:00\"\nis = \"discharge\"") +
          named("empty",
                "soc_max = 0.55\nhours = \"20:00-21:00\"\nprice_max = 95\nis = \"charge\""),
      "test.toml");
  const auto opposite = [&](int rule) {
    return nearest_opposite(rules, {-500, 1500}, ContextKind::kLevel, rules.rules[rule]).value();
  };
  EXPECT_EQ(opposite(0).name, "sell");
  EXPECT_EQ(opposite(0).price_gap_eur_per_mwh, 4);
  EXPECT_EQ(opposite(0).soc_gap, 0);
  EXPECT_EQ(opposite(1).name, "buy");
  EXPECT_EQ(opposite(3).name, "empty");
  EXPECT_EQ(opposite(3).price_gap_eur_per_mwh, 0);
  EXPECT_EQ(opposite(3).soc_gap, 10);
  EXPECT_FALSE(nearest_opposite(rules, {-501, 1501}, ContextKind::kLevel,
                                one_rule("never_rises_with = \"minute\"").rules[0]));
}

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
    const bool must_charge = price <= -200 && soc <= 100;
    const bool never_charges = price >= 60 && soc >= 140 && hour >= 12 && hour < 20;
    const ActionSet allowed = implied.at(hour, 1 + n % 12, soc, price);
    ASSERT_EQ(allows(allowed, Action::kDischarge), !must_charge && !(price <= 90 && soc <= 80))
        << price << ' ' << soc << ' ' << hour;
    ASSERT_EQ(allows(allowed, Action::kIdle), !must_charge && !(price >= -50 && price <= 30))
        << price << ' ' << soc << ' ' << hour;
    ASSERT_EQ(allows(allowed, Action::kCharge), !never_charges)
        << price << ' ' << soc << ' ' << hour;
  }
}

}  // namespace
}  // namespace bess
