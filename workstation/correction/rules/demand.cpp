// Every kind of demand of a rule: its keys in a rule file, its text forms and its predicate. The
// last rows list them.
#include <fmt/core.h>

#include <array>

#include "shared/host/toml_reader.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

// Demands is, is_not, at_least, at_most: the actions allowed in the box. Violated by each state of
// the box with another action.

class ActionDemand final : public PredicateDemand<ActionDemand> {
 public:
  explicit ActionDemand(ActionSet actions) : actions_(actions) {}

  [[nodiscard]] std::string text(const std::string& where) const override {
    const std::string_view low = action_name(lowest_of(actions_));
    const std::string_view high = action_name(highest_of(actions_));
    if (has_gap(actions_)) return fmt::format("{}: the action is not idle", where);
    if (low == high) return fmt::format("{}: the action is {}", where, low);
    return is_lower_end() ? fmt::format("{}: the action is at least {}", where, low)
                          : fmt::format("{}: the action is at most {}", where, high);
  }

  [[nodiscard]] std::string line() const override {
    const std::string_view low = action_name(lowest_of(actions_));
    const std::string_view high = action_name(highest_of(actions_));
    if (has_gap(actions_)) return "is_not = \"idle\"\n";
    if (low == high) return fmt::format("is = \"{}\"\n", low);
    return is_lower_end() ? fmt::format("at_least = \"{}\"\n", low)
                          : fmt::format("at_most = \"{}\"\n", high);
  }

  [[nodiscard]] ActionSet actions() const override { return actions_; }

  [[nodiscard]] auto predicate() const {
    const auto lowest = static_cast<std::int8_t>(lowest_of(actions_));
    const auto highest = static_cast<std::int8_t>(highest_of(actions_));
    constexpr auto kIdle = static_cast<std::int8_t>(Action::kIdle);
    const std::int8_t forbidden = has_gap(actions_) ? kIdle : std::int8_t{-1};
    return [=](std::int8_t here, std::int8_t /*neighbour*/) {
      return (here < lowest) | (here > highest) | (here == forbidden);
    };
  }

 private:
  [[nodiscard]] bool is_lower_end() const { return highest_of(actions_) == Action::kCharge; }

  ActionSet actions_;
};

constexpr std::array<std::string_view, 4> kActionKeys{"is", "is_not", "at_least", "at_most"};

bool is_left(std::string_view key, Action other, Action named) {
  if (key == "is") return other == named;
  if (key == "is_not") return other != named;
  return key == "at_least" ? other >= named : other <= named;
}

void read_action(TomlTable& table, std::string_view key, Rule& rule) {
  int named = 0;
  table.choice(key, named, {"discharge", "idle", "charge"});
  ActionSet actions = 0;
  for (int a = 0; a < kActionCount; ++a) {
    const auto other = static_cast<Action>(a);
    if (!is_left(key, other, static_cast<Action>(named))) continue;
    actions = static_cast<ActionSet>(actions | action_bit(other));
  }
  if (actions == kAllActions) table.fail(key, "allows every action: use another one");
  rule.demand = action_demand(actions);
}

// Demands never_rises_with, never_falls_with: direction of the action along one input. Violated by
// each pair of neighbours between which the action moves the other way.

struct InputName {
  std::string_view key, text;
};
constexpr InputName kInputs[kRuleInputCount] = {{"minute", "the minute of the quarter-hour"},
                                                {"quarter_hour", "the quarter-hour"},
                                                {"context_class", "the context class"},
                                                {"soc", "the SoC"},
                                                {"price", "the price"}};

class DirectionDemand final : public PredicateDemand<DirectionDemand> {
 public:
  explicit DirectionDemand(const Direction& direction) : direction_(direction) {}

  [[nodiscard]] std::string text(const std::string& /*where*/) const override {
    return fmt::format("the action never {} with {}", verb(), input().text);
  }
  [[nodiscard]] std::string line() const override {
    return fmt::format("never_{}_with = \"{}\"\n", verb(), input().key);
  }
  [[nodiscard]] Direction direction() const override { return direction_; }
  [[nodiscard]] std::optional<RuleInput> pairs_along() const override { return direction_.input; }

  [[nodiscard]] auto predicate() const {
    const auto flip =
        static_cast<std::int8_t>(direction_.sign < 0 ? -1 : 0);  // negation without multiplication
    return [=](std::int8_t here, std::int8_t neighbour) {
      return static_cast<std::int8_t>(((neighbour - here) ^ flip) - flip) < 0;
    };
  }

 private:
  [[nodiscard]] const char* verb() const { return direction_.sign > 0 ? "falls" : "rises"; }
  [[nodiscard]] const InputName& input() const {
    return kInputs[static_cast<std::size_t>(direction_.input)];
  }

  Direction direction_;
};

constexpr std::array<std::string_view, 2> kDirectionKeys{"never_rises_with", "never_falls_with"};

void read_direction(TomlTable& table, std::string_view key, Rule& rule) {
  int input = 0;
  table.choice(key, input,
               {kInputs[0].key, kInputs[1].key, kInputs[2].key, kInputs[3].key, kInputs[4].key});
  const Direction direction{static_cast<RuleInput>(input), key == "never_rises_with" ? -1 : 1};
  rule.demand = direction_demand(direction);
  if (rule.box != RuleBox{}) {
    table.fail(key, "applies everywhere: remove hours, months, classes, SoC and price");
  }
  if (input >= static_cast<int>(RuleInput::kSoc) && direction.sign > 0) {
    table.fail(key, "contradicts property 3: the action never rises with price or SoC");
  }
  if (rule.enforce) {
    table.fail("enforce", "needs a demand on single states: the guard sees one state at a time");
  }
}

// Demand power_max: limit of the power in the box, enforced by the guard. It does not bind the
// student, which decides directions only.

class PowerDemand final : public PredicateDemand<PowerDemand> {
 public:
  explicit PowerDemand(std::int32_t permille_max) : permille_max_(permille_max) {}

  [[nodiscard]] std::string text(const std::string& where) const override {
    return fmt::format("{}: at most {:g} % of the rated power", where, permille_max_ / 10.0);
  }
  [[nodiscard]] std::string line() const override {
    return fmt::format("power_max = {:g}\n", permille_max_ / double{kFullPowerPermille});
  }
  [[nodiscard]] std::int32_t power_permille_max() const override { return permille_max_; }
  [[nodiscard]] bool binds_student() const override { return false; }
  [[nodiscard]] auto predicate() const {
    return [](std::int8_t /*here*/, std::int8_t /*neighbour*/) { return false; };
  }

 private:
  std::int32_t permille_max_;
};

constexpr std::array<std::string_view, 1> kPowerKeys{"power_max"};

void read_power(TomlTable& table, std::string_view key, Rule& rule) {
  std::int32_t permille_max = kFullPowerPermille;
  table.scaled(key, permille_max, kFullPowerPermille, 0, 1);
  if (permille_max == kFullPowerPermille) table.fail(key, "is no limit: use less than 1");
  if (!rule.enforce) table.fail(key, "applies to the guard only: add enforce = true");
  rule.demand = std::make_shared<PowerDemand>(permille_max);
}

// Demands charge_at_or_below, discharge_at_or_above: threshold of property 1 or 2 at another price.
// The property itself is unchanged.

constexpr std::array<std::string_view, 2> kThresholdKeys{"charge_at_or_below",
                                                         "discharge_at_or_above"};

void read_threshold(TomlTable& table, std::string_view key, Rule& rule) {
  if (rule.box != RuleBox{}) {
    table.fail(key, "applies at every hour and SoC: to restrict it use is = with a box");
  }
  const bool charges = key == "charge_at_or_below";
  auto& price = charges ? rule.box.price_max_eur_per_mwh : rule.box.price_min_eur_per_mwh;
  table.integer(key, price, -kThresholdMaxEurPerMwh, kThresholdMaxEurPerMwh);
  rule.demand = action_demand(action_bit(charges ? Action::kCharge : Action::kDischarge));
  rule.is_threshold = true;
  if (rule.enforce) {
    table.fail("enforce",
               "is not for thresholds: the guard has its own, [guard] low_price_eur_per_mwh and "
               "high_price_eur_per_mwh of bess-edge.toml");
  }
}

}  // namespace

DemandPointer action_demand(ActionSet actions) { return std::make_shared<ActionDemand>(actions); }

DemandPointer direction_demand(const Direction& direction) {
  return std::make_shared<DirectionDemand>(direction);
}

/// In the order in which error messages list the keys.
std::span<const DemandKind> demand_kinds() {
  static constexpr DemandKind kKinds[] = {{kActionKeys, read_action},
                                          {kDirectionKeys, read_direction},
                                          {kPowerKeys, read_power},
                                          {kThresholdKeys, read_threshold}};
  return kKinds;
}

}  // namespace bess
