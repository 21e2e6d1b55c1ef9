// Operator rule, as read from a rule file (rule_file.h): a name, which every report uses, a box of
// states and one demand (demand.h):
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
#include <string>
#include <vector>

#include "shared/context_classes.h"
#include "shared/features.h"
#include "shared/price_thresholds.h"
#include "workstation/correction/rules/demand.h"

namespace bess {

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
  int property = 0;     ///< 1 to 3: one of the built-in rules (properties.h); 0: an operator's
  std::string place{};  ///< "FILE:LINE", for messages

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
  [[nodiscard]] std::vector<std::string> guard_rule_names() const;
};

/// Whether the proof of a student with this context counts the rule; else it is for the guard only.
bool binds_student(const Rule& rule, ContextKind kind);

/// Who applies the rule: "student", "guard", "student and guard", or "guard's own thresholds".
std::string held_by(const Rule& rule, ContextKind kind);

/// Whether some price of the box is on the lattice.
bool overlaps_lattice(const RuleBox& box);

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

}  // namespace bess
