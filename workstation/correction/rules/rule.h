// What an operator asks of every decision, as read from a rule file (rule_file.h). A rule has a
// name, which every report uses, a box of states and one demand (demand.h):
//
//   actions    in the box only some actions                            of each state
//   direction  the action never falls, or never rises, with one input  of each pair of neighbours
//   power      in the box at most so much of the rated power           the guard's alone
//   threshold  property 1 or 2 at another price
//
// The student is bound on the lattice alone: by what lies inside it, and by months only if it sees
// months.
#pragma once

#include <cstdint>
#include <optional>
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
/// Discharging and charging are allowed, and idling is not.
constexpr bool has_gap(ActionSet actions) {
  return actions == (action_bit(Action::kDischarge) | action_bit(Action::kCharge));
}

struct Rule {
  std::string name;
  RuleBox box;
  DemandPointer demand = action_demand(kAllActions);
  bool enforce = false;       ///< by the guard, whatever the student says
  bool is_threshold = false;  ///< stands for a threshold of properties 1 and 2
  int property = 0;     ///< 1 to 3: one of the built-in rules (properties.h); 0: an operator's
  std::string place{};  ///< "FILE:LINE", for messages

  [[nodiscard]] ActionSet actions() const { return demand->actions(); }
  [[nodiscard]] Action lowest() const { return lowest_of(actions()); }
  [[nodiscard]] Action highest() const { return highest_of(actions()); }
  [[nodiscard]] bool has_gap() const { return bess::has_gap(actions()); }
  /// Whether something is asked of single states, for a student to learn.
  [[nodiscard]] bool restricts_actions() const { return actions() != kAllActions; }
  /// Whether the layer can be asked for it: "not idle" is not convex.
  [[nodiscard]] bool has_rows() const { return restricts_actions() && !has_gap(); }
  /// "17:00-20:00, SoC at most 30 %: the action is at least idle".
  [[nodiscard]] std::string text() const;
};

struct RuleSet {
  std::vector<Rule> rules;

  [[nodiscard]] bool empty() const { return rules.empty(); }
  /// What is given, each threshold replaced by that of a rule.
  [[nodiscard]] PriceThresholds thresholds(PriceThresholds otherwise) const;
  /// Of properties 1 to 3 and the rules: the direction of each input, by RuleInput.
  [[nodiscard]] std::vector<Direction> directions() const;
  /// What the guard enforces, in the order of the rules.
  [[nodiscard]] std::vector<GuardRule> guard_rules() const;
  [[nodiscard]] std::vector<std::string> guard_rule_names() const;
};

/// Whether the proof of a student of this context counts the rule; else it is the guard's alone.
bool binds_student(const Rule& rule, ContextKind kind);

/// Who is held to the rule: "student", "guard", "student and guard", or "guard's own thresholds".
std::string held_by(const Rule& rule, ContextKind kind);

/// Whether some price of the box lies on the lattice.
bool overlaps_lattice(const RuleBox& box);

/// A box on the lattice: indices, ends included, and what it says of the context.
struct LatticeBox {
  int price_first, price_last;  ///< indices from kLatticePriceMinEurPerMwh
  int soc_first, soc_last;
  std::int32_t classes;  ///< bit c - 1, of the student's context
};

/// The part of a box that a student of this context sees. Precondition: some of it lies on the
/// lattice.
LatticeBox lattice_box_of(const RuleBox& box, ContextKind kind);

/// Whether the student sees the box at this hour and context class.
bool holds_in_context(const RuleBox& box, ContextKind kind, int quarter_hour, int context_class);

/// "17:00".
std::string hour_text(int quarter_hour);

}  // namespace bess
