// Rule demand interface. A kind of demand is one file (action_demand.cpp is the first to read) and
// one row of demand_kinds.cpp: its keys in a rule file, its text forms and its predicate. All other
// code uses three properties of a demand: the actions that it allows in the rule's box (rows of the
// layer, hinge losses, implied bounds, guard), how the action moves with an input, and the power
// that the guard allows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/decision_rule.h"

namespace bess {

class TomlTable;
struct Rule;

/// Inputs of the student, in its order.
enum class RuleInput : std::uint8_t { kMinute, kQuarterHour, kContextClass, kSoc, kPrice };
inline constexpr int kRuleInputCount = 5;

/// How the action may move when an input rises: +1 never falls, -1 never rises, 0 free.
struct Direction {
  RuleInput input = RuleInput::kPrice;
  int sign = 0;
  friend bool operator==(const Direction&, const Direction&) = default;
};

/// Actions of one SoC by price, and those of the neighbour that a demand on pairs compares with.
struct ActionRow {
  const std::int8_t* here;
  const std::int8_t* neighbour;
  int begin, end;  ///< price indices to check
};

class Demand {
 public:
  virtual ~Demand() = default;

  /// "17:00-20:00: the action is at least idle"; `where` is the rule's box.
  [[nodiscard]] virtual std::string text(const std::string& where) const = 0;
  /// Line of a rule file that parses to this demand.
  [[nodiscard]] virtual std::string line(const RuleBox& box) const = 0;

  /// Actions allowed in the box.
  [[nodiscard]] virtual ActionSet actions() const { return kAllActions; }
  [[nodiscard]] virtual Direction direction() const { return {}; }
  /// Limit of the power in 1/1000 of the rated power, both directions; enforced by the guard only.
  [[nodiscard]] virtual std::int32_t power_permille_max() const { return kFullPowerPermille; }

  /// Whether the proof counts it.
  [[nodiscard]] virtual bool binds_student() const { return true; }
  /// Input along which neighbours are compared; none if each state is checked by itself.
  [[nodiscard]] virtual std::optional<RuleInput> pairs_along() const { return {}; }
  /// Predicate of one state or pair; `neighbour` is the neighbour's action, or the state's own.
  [[nodiscard]] virtual bool is_broken(Action here, Action neighbour) const = 0;
  /// The same for a row: adds the price indices that violate it.
  virtual void broken(const ActionRow& row, std::vector<int>& prices) const = 0;
};

using DemandPointer = std::shared_ptr<const Demand>;

/// Requires one of these actions in every state of the box.
DemandPointer action_demand(ActionSet actions);
DemandPointer direction_demand(const Direction& direction);

/// Kind of demand: its keys in a rule file and the parser, called after the rule's box and
/// `enforce` are read.
struct DemandKind {
  std::span<const std::string_view> keys;
  void (*read)(TomlTable& table, std::string_view key, Rule& rule);
};
std::span<const DemandKind> demand_kinds();

/// Demand with a single predicate: `Kind::predicate()` returns a function of two actions.
template <typename Kind>
class PredicateDemand : public Demand {
 public:
  [[nodiscard]] bool is_broken(Action here, Action neighbour) const final {
    return predicate()(static_cast<std::int8_t>(here), static_cast<std::int8_t>(neighbour));
  }
  void broken(const ActionRow& row, std::vector<int>& prices) const final {
    const auto breaks = predicate();
    std::int8_t any = 0;  // as wide as an action, branch-free: vectorisable
    for (int p = row.begin; p < row.end; ++p) {
      any |= static_cast<std::int8_t>(breaks(row.here[p], row.neighbour[p]));
    }
    if (any == 0) return;
    for (int p = row.begin; p < row.end; ++p) {
      if (breaks(row.here[p], row.neighbour[p])) prices.push_back(p);
    }
  }

 private:
  [[nodiscard]] auto predicate() const { return static_cast<const Kind&>(*this).predicate(); }
};

}  // namespace bess
