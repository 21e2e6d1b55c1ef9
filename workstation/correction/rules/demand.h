// What a rule asks. A kind of demand is one file of this room (action_demand.cpp is the first to
// read) and one row of demand_kinds.cpp: its keys in a rule file, how it is said and written, and
// its predicate. Everything else follows from three facts that it may state: the actions that it
// leaves in the rule's box (the layer's rows, the hinges, what rules imply for each other, the
// guard), how the action moves with an input, and how much power the guard leaves.
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

/// How the action may move when an input rises; +1 never falls, -1 never rises, 0 as it likes.
struct Direction {
  RuleInput input = RuleInput::kPrice;
  int sign = 0;
  friend bool operator==(const Direction&, const Direction&) = default;
};

/// Actions of one SoC by price, and those of the neighbour that a demand on pairs compares with.
struct ActionRow {
  const std::int8_t* here;
  const std::int8_t* beside;
  int begin, end;  ///< price indices that are held against the demand
};

class Demand {
 public:
  virtual ~Demand() = default;

  /// "17:00-20:00: the action is at least idle"; `where` is the rule's box.
  [[nodiscard]] virtual std::string text(const std::string& where) const = 0;
  /// The line of a rule file that reads back to it.
  [[nodiscard]] virtual std::string line(const RuleBox& box) const = 0;

  /// What may be decided in the box.
  [[nodiscard]] virtual ActionSet actions() const { return kAllActions; }
  [[nodiscard]] virtual Direction direction() const { return {}; }
  /// Of the rated power, both directions; the guard's alone.
  [[nodiscard]] virtual std::int32_t power_permille_max() const { return kFullPowerPermille; }

  /// Whether the proof counts it at all.
  [[nodiscard]] virtual bool binds_student() const { return true; }
  /// The input along which neighbours are compared; none where each state is held by itself.
  [[nodiscard]] virtual std::optional<RuleInput> pairs_along() const { return {}; }
  /// The predicate, of one state or pair; `beside` is the neighbour's action, or its own.
  [[nodiscard]] virtual bool is_broken(Action here, Action beside) const = 0;
  /// The same of a row: adds the price indices at which it is broken.
  virtual void broken(const ActionRow& row, std::vector<int>& prices) const = 0;
};

using DemandPointer = std::shared_ptr<const Demand>;

/// Of every state in the box one of these actions; of all actions: asks for nothing.
DemandPointer action_demand(ActionSet actions);
DemandPointer direction_demand(const Direction& direction);

/// A kind: the keys of a rule file that make it, and what reads one of them into a rule whose box
/// and `enforce` are read already.
struct DemandKind {
  std::span<const std::string_view> keys;
  void (*read)(TomlTable& table, std::string_view key, Rule& rule);
};
std::span<const DemandKind> demand_kinds();

/// A demand of which the predicate is written once: `Kind::predicate()` gives a function of two
/// actions as they stand in a row.
template <typename Kind>
class PredicateDemand : public Demand {
 public:
  [[nodiscard]] bool is_broken(Action here, Action beside) const final {
    return predicate()(static_cast<std::int8_t>(here), static_cast<std::int8_t>(beside));
  }
  void broken(const ActionRow& row, std::vector<int>& prices) const final {
    const auto breaks = predicate();
    std::int8_t any = 0;  // as wide as an action, branch-free: vectorises
    for (int p = row.begin; p < row.end; ++p) {
      any |= static_cast<std::int8_t>(breaks(row.here[p], row.beside[p]));
    }
    if (any == 0) return;
    for (int p = row.begin; p < row.end; ++p) {
      if (breaks(row.here[p], row.beside[p])) prices.push_back(p);
    }
  }

 private:
  [[nodiscard]] auto predicate() const { return static_cast<const Kind&>(*this).predicate(); }
};

}  // namespace bess
