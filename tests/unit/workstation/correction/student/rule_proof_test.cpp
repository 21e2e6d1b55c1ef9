// Proof of an operator's rules: each predicate against brute force from its definition, on nets
// that satisfy it and on nets that violate only it.
#include "workstation/correction/student/certificate.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"

namespace bess {
namespace {

constexpr int kFirstContextAlone = kContextCount;  ///< stride: the first context alone

/// Every action of a context and of its neighbours, by enumeration.
class Actions {
 public:
  Actions(const StudentNet& net, const LatticeState& context) {
    fill(net, context, here_);
    for (const RuleInput input :
         {RuleInput::kMinute, RuleInput::kQuarterHour, RuleInput::kContextClass}) {
      const auto next = next_state(context, input);
      if (next) fill(net, *next, beside_[static_cast<std::size_t>(input)]);
    }
  }
  [[nodiscard]] Action at(int soc, int price) const { return in(here_, soc, price); }
  /// In the next context along the input; none after its last value.
  [[nodiscard]] std::optional<Action> neighbour(RuleInput input, int soc, int price) const {
    const auto which = static_cast<std::size_t>(input);
    if (which >= beside_.size() || beside_[which].empty()) return {};
    return in(beside_[which], soc, price);
  }

 private:
  static void fill(const StudentNet& net, const LatticeState& s, ActionGrid& grid) {
    fill_action_grid(net, s, true, grid);
  }
  static Action in(const ActionGrid& grid, int soc, int price) {
    return static_cast<Action>(
        grid[static_cast<std::size_t>(soc * kPriceCount + price - kLatticePriceMinEurPerMwh)]);
  }
  ActionGrid here_;
  std::array<ActionGrid, 3> beside_;
};

/// For one context, by definition.
std::int64_t brute_force(const Rule& rule, const Actions& actions, const LatticeState& context) {
  std::int64_t found = 0;
  for (int soc = 0; soc < kSocCount; ++soc) {
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; ++price) {
      const RulePoint point{price, static_cast<std::int16_t>(soc), context.quarter_hour, 1,
                            context.context_class};
      if (!rule.box.contains(point)) continue;
      const Action action = actions.at(soc, price);
      const Direction direction = rule.demand->direction();
      found += allows(rule.actions(), action) ? 0 : 1;
      if (direction.sign == 0) continue;
      const RuleInput input = direction.input;
      std::optional<Action> after = actions.neighbour(input, soc, price);
      if (input == RuleInput::kPrice && price < kLatticePriceMaxEurPerMwh) {
        after = actions.at(soc, price + 1);
      }
      if (input == RuleInput::kSoc && soc < kSocCount - 1) after = actions.at(soc + 1, price);
      if (!after) continue;
      found += (direction.sign < 0 ? *after > action : *after < action) ? 1 : 0;
    }
  }
  return found;
}

/// Each demand with a distinct shape: a predicate that is omitted, or looks elsewhere, miscounts
/// some.
std::vector<const char*> rule_shapes() {
  return {"is = \"idle\"\nprice_min = -20\nprice_max = 700\nsoc_min = 0.1\nsoc_max = 0.8",
          "is = \"charge\"\nprice_max = -300",
          "is = \"discharge\"\nprice_min = 900",
          "is_not = \"idle\"\nsoc_min = 0.3",
          "is_not = \"charge\"\nprice_min = 100",
          "is_not = \"discharge\"\nprice_max = 400\nsoc_max = 0.5",
          "at_least = \"idle\"\nhours = \"23:00-01:00\"",
          "at_most = \"idle\"\ncontext_classes = [1, 7]",
          "at_most = \"idle\"\nhours = \"05:00-06:00\"",
          "never_rises_with = \"price\"",
          "never_rises_with = \"soc\"",
          "never_rises_with = \"minute\"",
          "never_falls_with = \"minute\"",
          "never_rises_with = \"quarter_hour\"",
          "never_falls_with = \"quarter_hour\"",
          "never_rises_with = \"context_class\"",
          "never_falls_with = \"context_class\"",
          "charge_at_or_below = -100",
          "discharge_at_or_above = 700"};
}

RuleSet all_shapes() {
  RuleSet all;
  int n = 0;
  for (const char* lines : rule_shapes()) {
    all.rules.push_back(one_rule(lines, "rule " + std::to_string(++n)).rules[0]);
  }
  return all;
}

/// The action falls (sign 1) or rises (-1) with minute, quarter-hour, class and SoC.
StudentNet tilted_net(int sign) {
  StudentNet net = LinearNet{.soc_weight = sign, .offset = 4000}.net();
  for (int input = 0; input < 3; ++input) {
    net.layer1.weight[input][0] = static_cast<std::int16_t>(sign);
  }
  return net;
}

/// Charges, idles, discharges, idles and charges again as the price rises.
StudentNet wavy_net() {
  StudentNet net = LinearNet{.charge_below = 1000, .discharge_from = 4000}.net();
  net.layer1.weight[4][1] = 1;
  net.layer1.bias[1] = -5000;
  net.layer2.weight[1][0] = -3;
  return net;
}

TEST(RuleProof, CountsAreThoseOfTheDefinitions) {
  const RuleSet rules = all_shapes();
  const StudentNet nets[] = {seeded_net(1), tilted_net(1), tilted_net(-1), wavy_net()};
  std::vector<std::int64_t> seen(rules.rules.size());
  for (const StudentNet& by_month : nets) {
    StudentNet net = by_month;
    net.context.kind = ContextKind::kLevel;
    for (int c = 0; c + 1 < kContextClassCount; ++c) {
      net.context.level_edge_eur_per_mwh[c] = static_cast<std::int16_t>(10 * c);
    }
    const Certificate certificate =
        verify_student(net, {.rules = rules, .context_stride = kFirstContextAlone, .threads = 1});
    ASSERT_EQ(certificate.rule_counts().size(), rules.rules.size());
    const Actions actions(net, context_at(0));
    std::int64_t sum = 0;
    for (int property = 1; property <= kPropertyCount; ++property) {
      sum += certificate.violations_of(property);
    }
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      SCOPED_TRACE(rules.rules[r].text());
      const std::int64_t expected = brute_force(rules.rules[r], actions, context_at(0));
      const RuleCount& count = certificate.rule_counts()[r];
      EXPECT_EQ(count.violations, expected);
      EXPECT_TRUE(count.binds_student);
      EXPECT_EQ(count.counterexamples.empty(), expected == 0);
      seen[r] += expected;
      sum += expected;
    }
    EXPECT_EQ(certificate.violations(), sum);
  }
  for (std::size_t r = 0; r < seen.size(); ++r) {
    // The box at 05:00 is not in the first context; each other shape is violated by some net.
    const bool is_elsewhere = rules.rules[r].box.quarter_hour_first == 20;
    EXPECT_EQ(seen[r] > 0, !is_elsewhere) << rules.rules[r].text();
  }
}

/// Over a sample of contexts: hours, classes and the last values of an input, which have no
/// successor.
TEST(RuleProof, CountsOfManyContextsAddUp) {
  const RuleSet rules = all_shapes();
  StudentNet net = seeded_net(5);
  constexpr int kStride =
      5759;  // the last is at the end of the day and of the classes: no successor
  const Certificate two =
      verify_student(net, {.rules = rules, .context_stride = kStride, .threads = 2});
  const Certificate one =
      verify_student(net, {.rules = rules, .context_stride = kStride, .threads = 1});
  std::vector<std::int64_t> expected(rules.rules.size());
  for (int c = 0; c < kContextCount; c += kStride) {
    const LatticeState context = context_at(c);
    const Actions actions(net, context);
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      Rule rule = rules.rules[r];
      // By month the classes of the net are months.
      if (!holds_in_context(rule.box, ContextKind::kMonth, context.quarter_hour,
                            context.context_class)) {
        continue;
      }
      rule.box.context_classes = rule.box.months = kAllTwelve;
      expected[r] += brute_force(rule, actions, context);
    }
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    SCOPED_TRACE(rules.rules[r].text());
    EXPECT_EQ(one.rule_counts()[r].violations, expected[r]);
    EXPECT_EQ(two.rule_counts()[r].violations, expected[r]) << "threads";
    EXPECT_EQ(two.rule_counts()[r].states, one.rule_counts()[r].states);
  }
}

TEST(RuleProof, WhatDoesNotBindTheStudentIsNotCounted) {
  RuleSet rules = one_rule("months = [1]\nis = \"idle\"\nenforce = true");
  rules.rules.push_back(one_rule("power_max = 0\nenforce = true", "cap").rules[0]);
  rules.rules.push_back(
      one_rule("price_min = 1501\nis = \"idle\"\nenforce = true", "far").rules[0]);
  StudentNet net = LinearNet{}.net();
  const VerifyOptions options{.rules = rules, .context_stride = kFirstContextAlone, .threads = 1};
  const Certificate by_month = verify_student(net, options);
  EXPECT_GT(by_month.rule_counts()[0].violations, 0) << "a student by month sees January";
  net.context.kind = ContextKind::kLevel;
  const Certificate by_level = verify_student(net, options);
  for (const RuleCount& count : by_level.rule_counts()) {
    EXPECT_FALSE(count.binds_student);
    EXPECT_EQ(count.violations + count.states, 0);
  }
}

TEST(RuleProof, AStudentWithUncheckedRulesIsNotCovered) {
  Certificate claim{.states_checked = kLatticeStateCount};
  EXPECT_TRUE(claim.covers_lattice_without_violation());
  claim.rules = one_rule("is = \"idle\"");
  EXPECT_FALSE(claim.covers_lattice_without_violation());
  claim.counts.resize(kBuiltInRuleCount + 1);
  EXPECT_TRUE(claim.covers_lattice_without_violation());
  claim.counts.back().violations = 1;
  EXPECT_FALSE(claim.covers_lattice_without_violation());
}

/// LinearNet falls with price: "no discharge below 800" is worst at the highest price of the box.
TEST(RuleProof, TheWorstStateIsTheOneTheStudentIsSurestOf) {
  const RuleSet rules = one_rule("price_max = 1400\nat_least = \"idle\"");
  const StudentNet net = LinearNet{}.net();
  const Certificate certificate =
      verify_student(net, {.rules = rules, .context_stride = kFirstContextAlone, .threads = 1});
  const auto worst = worst_state(net, rules.rules[0], certificate.rule_counts()[0]);
  ASSERT_TRUE(worst);
  EXPECT_EQ(worst->state.price_eur_per_mwh, 1400);
  EXPECT_EQ(worst->action, Action::kDischarge);
  EXPECT_EQ(worst->lead, 8 * 1900 - 12'000);
  EXPECT_FALSE(worst_state(net, one_rule("price_min = 400\nat_most = \"idle\"").rules[0], {}));
}

}  // namespace
}  // namespace bess
