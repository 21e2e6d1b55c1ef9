// Demands is, is_not, at_least, at_most: the actions allowed in the box. Violated by each state of
// the box with another action.
#include <fmt/core.h>

#include <array>

#include "shared/host/toml_reader.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

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

  [[nodiscard]] std::string line(const RuleBox& /*box*/) const override {
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

constexpr std::array<std::string_view, 4> kKeys{"is", "is_not", "at_least", "at_most"};

bool is_left(std::string_view key, Action other, Action named) {
  if (key == "is") return other == named;
  if (key == "is_not") return other != named;
  return key == "at_least" ? other >= named : other <= named;
}

void read(TomlTable& table, std::string_view key, Rule& rule) {
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

}  // namespace

DemandPointer action_demand(ActionSet actions) { return std::make_shared<ActionDemand>(actions); }

DemandKind action_kind() { return {kKeys, read}; }

}  // namespace bess
