// Whether rules can be obeyed together, found out before anything is trained.
//
// On the lattice a demand reaches further than its box: where the action never rises with price and
// SoC, "at least A" holds at every lower price and SoC too, and "at most A" at every higher one. So
// a rule claims the states that its box implies, which is a box again, and two rules clash where
// one claims more than the other allows. What the guard enforces is held against the bare boxes.
#pragma once

#include <optional>
#include <string>

#include "workstation/correction/rules/rule.h"

namespace bess {

/// Throws UserError naming the rules and one state when they contradict each other or the
/// thresholds of properties 1 and 2, or when a rule binds nobody: neither a student of this context
/// nor the guard.
void require_consistent(const RuleSet& rules, const PriceThresholds& thresholds, ContextKind kind);

/// The demand nearest to a rule that asks the opposite in some hour and class of both, and how far
/// off it is: of what lies between, a student must turn from one to the other.
struct Opposite {
  std::string name;
  int price_gap_eur_per_mwh = 0;  ///< 0: they meet in price, and lie apart in charge
  int soc_gap = 0;                ///< in lattice steps; 0: they meet in charge
};
/// None for a rule without an opposite. `rule` is one of the set or a threshold.
std::optional<Opposite> nearest_opposite(const RuleSet& rules, const PriceThresholds& thresholds,
                                         ContextKind kind, const Rule& rule);

/// The actions that are left at a lattice state when all rules that bind a student are obeyed, and
/// the action keeps its directions: `lowest` to `highest`, without idling where `has_gap`.
struct ActionRange {
  Action lowest = Action::kDischarge;
  Action highest = Action::kCharge;
  bool has_gap = false;

  [[nodiscard]] ActionSet set() const;
};

/// Ranges at single states, for training and pricing. Keeps nothing of `rules`.
class ImpliedRanges {
 public:
  ImpliedRanges(const RuleSet& rules, ContextKind kind);
  [[nodiscard]] ActionRange at(int quarter_hour, int context_class, int soc_index,
                               int price_eur_per_mwh) const;
  [[nodiscard]] bool empty() const { return claims_.empty(); }

 private:
  friend void require_consistent(const RuleSet&, const PriceThresholds&, ContextKind);
  friend std::optional<Opposite> nearest_opposite(const RuleSet&, const PriceThresholds&,
                                                  ContextKind, const Rule&);

  enum class Side : std::uint8_t { kAtLeast, kAtMost, kNotIdle };
  /// One side of a demand with all states that it reaches.
  struct Claim {
    Side side;
    Action action;
    std::size_t rule;  ///< index
    LatticeBox box;
    std::vector<bool> quarter_hours;
  };
  void add_claim(const Rule& rule, std::size_t index, Side side, Action action,
                 const std::vector<Direction>& directions, ContextKind kind);

  std::vector<Claim> claims_;
};

}  // namespace bess
