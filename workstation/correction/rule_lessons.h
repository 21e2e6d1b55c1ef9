// How a student learns rules while it is distilled, the teacher untouched: what the teacher would
// do against an operator's rule is taken out of the lessons, and some states of every batch are
// held to every rule, the built-in ones too, by hinges. Of a monotone student one or two corners of
// a rule's box tell for all of it, in each context.
#pragma once

#include <vector>

#include "workstation/base/random.h"
#include "workstation/rl/network_input.h"
#include "workstation/rl/price_map.h"
#include "workstation/rules/rule_conflicts.h"

namespace bess {

/// A state that decides a rule in its context, and what is allowed there.
struct HardState {
  LatticeState state;
  ActionSet actions;
  std::size_t rule = 0;  ///< index in the set
};

/// Which states of a rule decide it, for the hinges and for a quick look before a proof. Rules that
/// do not bind the student's states are left out; a direction is the signs' (sign_bounds.h).
class RuleLessons {
 public:
  RuleLessons(const RuleSet& rules, ContextKind kind);

  [[nodiscard]] bool empty() const { return asked_.empty(); }
  [[nodiscard]] std::size_t count() const { return asked_.size(); }

  /// A hard state of rule `index` < count(), in a context of its box: half of them in one of
  /// `counterexamples`, where there are some.
  HardState draw(std::size_t index, const std::vector<LatticeState>& counterexamples,
                 Random& random) const;

  /// What a monotone student is held to in this context; rules without corners are left out.
  void corners(const LatticeState& context, std::vector<HardState>& states) const;

  /// The actions that the operator's rules leave at a network input.
  [[nodiscard]] ActionSet actions_at(const float* x, const PriceMap& price_map) const;

 private:
  struct Asked {
    std::size_t index;  ///< in the set
    Rule rule;
    LatticeBox box;
    bool has_corners;  ///< else any state of the box may be the worst
  };
  [[nodiscard]] bool holds(const Asked& asked, const LatticeState& context) const;
  [[nodiscard]] LatticeState draw_context(const Asked& asked, Random& random) const;
  static HardState corner(const Asked& asked, LatticeState context, bool at_least);

  ContextKind kind_;
  std::vector<Asked> asked_;
  ImpliedRanges implied_;
};

}  // namespace bess
