// Conflict check of rules before training.
//
// On the lattice a demand applies beyond its box: where the action never rises with price and SoC,
// "at least A" also applies at every lower price and SoC, "at most A" at every higher one. A rule
// therefore implies bounds on a larger box, and two rules conflict where the bounds contradict.
// Rules of the guard are compared within their own boxes.
#pragma once

#include <bitset>
#include <optional>
#include <string>

#include "workstation/correction/rules/rule.h"

namespace bess {

/// Throws UserError naming the rules and one state if they contradict each other or the thresholds
/// of properties 1 and 2, or if a rule binds neither a student with this context nor the guard.
void require_consistent(const RuleSet& rules, const PriceThresholds& thresholds, ContextKind kind);

/// The nearest demand for the opposite of a rule in a common hour and class, with its distance:
/// between the two a student must change its action.
struct Opposite {
  std::string name;
  int price_gap_eur_per_mwh = 0;  ///< 0: they touch in price and differ in SoC
  int soc_gap = 0;                ///< in lattice steps; 0: they touch in SoC
};
/// None for a rule without an opposite. `rule` is one of the set or a threshold.
std::optional<Opposite> nearest_opposite(const RuleSet& rules, const PriceThresholds& thresholds,
                                         ContextKind kind, const Rule& rule);

enum class BoundSide : std::uint8_t { kAtLeast, kAtMost, kNotIdle };
/// One side of a demand with all states for which it implies a bound.
struct ImpliedBound {
  BoundSide side;
  Action action;
  ActionSet allowed;
  std::size_t rule;  ///< index
  LatticeBox box;
  std::bitset<kQuarterHourCount> quarter_hours;
};

/// Actions allowed at a lattice state by all rules that bind a student, directions included, for
/// training and evaluation. Keeps no reference to `rules`.
class ImpliedRanges {
 public:
  ImpliedRanges(const RuleSet& rules, ContextKind kind);
  [[nodiscard]] ActionSet at(int quarter_hour, int context_class, int soc_index,
                             int price_eur_per_mwh) const;
  [[nodiscard]] const std::vector<ImpliedBound>& bounds() const { return bounds_; }

 private:
  void add_bound(const Rule& rule, std::size_t index, BoundSide side, Action action,
                 const std::vector<Direction>& directions, ContextKind kind);

  std::vector<ImpliedBound> bounds_;
};

}  // namespace bess
