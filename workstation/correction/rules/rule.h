// Operator rule, as read from a rule file (below): a name, which every report uses, a box of
// states and one demand:
//
//   actions    in the box only some actions                            each state
//   direction  the action never falls, or never rises, with one input  each pair of neighbours
//   power      in the box at most this share of the rated power        guard only
//   threshold  property 1 or 2 at another price
//
// A rule binds the student on the lattice only, and by months only if the student's context is the
// month.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/context_classes.h"
#include "shared/decision_rule.h"
#include "shared/features.h"
#include "shared/price_thresholds.h"

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

/// A kind of demand is a class and a row of demand_kinds(), both in demand.cpp. All other code uses
/// three properties of a demand: the actions that it allows in the rule's box (rows of the layer,
/// hinge losses, implied bounds, guard), how the action moves with an input, and the power that the
/// guard allows.
class Demand {
 public:
  virtual ~Demand() = default;

  /// "17:00-20:00: the action is at least idle"; `where` is the rule's box.
  [[nodiscard]] virtual std::string text(const std::string& where) const = 0;
  /// Line of a rule file that parses to this demand.
  [[nodiscard]] virtual std::string line() const = 0;

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

constexpr Action lowest_of(ActionSet actions) {
  return nearest_allowed(actions, Action::kDischarge);
}
constexpr Action highest_of(ActionSet actions) { return nearest_allowed(actions, Action::kCharge); }
/// Discharging and charging are allowed, idling is not.
constexpr bool has_gap(ActionSet actions) {
  return actions == (action_bit(Action::kDischarge) | action_bit(Action::kCharge));
}

struct Rule {
  std::string name;
  RuleBox box;
  DemandPointer demand = action_demand(kAllActions);
  bool enforce = false;       ///< by the guard too
  bool is_threshold = false;  ///< replaces a threshold of property 1 or 2
  int property = 0;           ///< 1 to 3: one of the built-in rules (below); 0: an operator's
  std::string place{};        ///< "FILE:LINE", for messages

  [[nodiscard]] ActionSet actions() const { return demand->actions(); }
  [[nodiscard]] Action lowest() const { return lowest_of(actions()); }
  [[nodiscard]] Action highest() const { return highest_of(actions()); }
  [[nodiscard]] bool has_gap() const { return bess::has_gap(actions()); }
  /// Whether it restricts actions of single states, which a student can be trained on.
  [[nodiscard]] bool restricts_actions() const { return actions() != kAllActions; }
  /// Whether the layer has rows for it: "not idle" is not convex.
  [[nodiscard]] bool has_rows() const { return restricts_actions() && !has_gap(); }
  /// "17:00-20:00, SoC at most 30 %: the action is at least idle".
  [[nodiscard]] std::string text() const;
};

struct RuleSet {
  std::vector<Rule> rules;

  [[nodiscard]] bool empty() const { return rules.empty(); }
  /// The given thresholds, replaced by those of rules.
  [[nodiscard]] PriceThresholds thresholds(PriceThresholds otherwise) const;
  /// Direction of each input, by RuleInput, from properties 1 to 3 and the rules.
  [[nodiscard]] std::vector<Direction> directions() const;
  /// Rules that the guard enforces, in order.
  [[nodiscard]] std::vector<GuardRule> guard_rules() const;
};

/// Whether the proof of a student with this context counts the rule; else it is for the guard only.
bool binds_student(const Rule& rule, ContextKind kind);

/// Who applies the rule: "student", "guard", "student and guard", or "guard's own thresholds".
std::string held_by(const Rule& rule, ContextKind kind);

/// Whether some price of the box is on the lattice.
bool overlaps_lattice(const RuleBox& box);

/// State of a context with SoC and price 0.
constexpr LatticeState lattice_context(int minute_of_quarter_hour, int quarter_hour,
                                       int context_class) {
  return {static_cast<std::int16_t>(minute_of_quarter_hour),
          static_cast<std::int16_t>(quarter_hour), static_cast<std::int16_t>(context_class), 0, 0};
}
/// The state of the same context at these indices.
constexpr LatticeState at_indices(LatticeState context, int soc, int price) {
  context.soc_index = static_cast<std::int16_t>(soc);
  context.price_eur_per_mwh = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + price);
  return context;
}

/// Box on the lattice (indices, ends included) with its context classes.
struct LatticeBox {
  int price_first, price_last;  ///< indices from kLatticePriceMinEurPerMwh
  int soc_first, soc_last;
  std::int32_t classes;  ///< bit c - 1, of the student's context

  [[nodiscard]] bool contains(int soc, int price) const {
    return soc >= soc_first && soc <= soc_last && price >= price_first && price <= price_last;
  }
};

/// The part of a box that a student with this context sees. Precondition: some of it is on the
/// lattice.
LatticeBox lattice_box_of(const RuleBox& box, ContextKind kind);

/// Whether the student sees the box at this hour and context class.
bool holds_in_context(const RuleBox& box, ContextKind kind, int quarter_hour, int context_class);

/// "17:00".
std::string hour_text(int quarter_hour);

/// "1, 2, 11": the members of a set of months or classes.
std::string members_text(std::int32_t bits);

// The three properties [SPEC 5] as built-in rules in the form of operator's rules: charge at or
// below the low price, discharge at or above the high price, and two directions (property 3: price
// and SoC).

inline constexpr int kPropertyCount = 3;
inline constexpr std::size_t kBuiltInRuleCount = 4;

/// The four built-in rules for these thresholds.
RuleSet built_in_rules(const PriceThresholds& thresholds);
/// The built-in rules, then the operator's.
RuleSet with_built_in(const PriceThresholds& thresholds, const RuleSet& rules);
/// The same with the given thresholds, as far as the rules do not replace them.
RuleSet with_properties(const RuleSet& rules, const PriceThresholds& thresholds);

/// "charge at or below -500 EUR/MWh"; `property` is 1 to 3.
std::string property_text(int property, const PriceThresholds& thresholds);

// Additional rule of a student with the outlook context: the action never falls when the plan's
// break-even price rises. In the plan that price never rises with SoC
// (shared/outlook/outlook_plan.h), so with property 3 the decision never rises with SoC.

/// `rules` with the additional rule, unless already present.
RuleSet with_outlook_rule(const RuleSet& rules);

// Rule file: commented TOML, one [[rule]] each (examples: workstation/config/rules/). Keys:
//
//   name = "no dear charging"                  1 to 40 letters, digits, spaces or -_.,:()%+; unique
//   hours = "22:00-06:00"                      local, whole quarter-hours, the end excluded; may
//                                              span midnight
//   months = [11, 12, 1, 2]                    local; binds only students with the month context
//   context_classes = [1, 2]                   of the price level, 1 the lowest; not with months
//   soc_min = 0.1, soc_max = 0.3               fractions, multiples of 0.005, ends included
//   price_min = 301, price_max = 1000          whole EUR/MWh, -15000..15000, ends included
//   is | is_not | at_least | at_most = "idle"  one demand: the action; discharge < idle < charge
//   never_rises_with | never_falls_with = "price"   or: its direction; minute, quarter_hour,
//                                              context_class, soc, price
//   power_max = 0.5                            or: share of the rated power; guard only
//   charge_at_or_below | discharge_at_or_above = 0  or: a threshold of property 1 or 2, EUR/MWh
//   enforce = true                             by the guard too

/// Limit of the edge's constant table, comments and log lines.
inline constexpr std::size_t kNameLengthMax = 40;

/// Throws UserError naming file, line, key and remedy; names must be unique.
RuleSet parse_rules(std::string_view text, const std::string& name);
/// All rules of several files; empty without files.
RuleSet load_rules(const std::vector<std::string>& paths);

/// Text of a rule file that parses to the same rules.
std::string format_rules(const RuleSet& rules);

}  // namespace bess
