// Distillation into a student that is monotone by construction: sign bounds on its weights give
// property 3, so training has one objective, the student's profit:
//
//   L = fidelity KL(mu || pi') + E_pi'[regret] / temperature   mu = softmax(values / temperature)
//
// over states that the teacher visits and some of the whole lattice, with hinge losses where rules
// apply (properties 1 and 2, operator's rules): because of monotonicity one or two states for each
// context suffice. Hidden activations saturate at 0 and 1: sums can bend both ways.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "workstation/base/random.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

// Signs of the weights of a student that is monotone by construction [SPEC 5, property 3], in the
// student's 5-64-32-3 layout. Monotone networks: Sill (1998), Daniels and Velikova (2010). Falling,
// rising and free units in one layer: constrained monotone network [Runje and Shankaranarayana
// 2023].
//
//   hidden 1   20 units fall with price and SoC (weights <= 0), 20 rise (>= 0), 24 ignore them;
//              time and context enter all of them freely
//   hidden 2   16 falling units: weights >= 0 from falling, <= 0 from rising, free from the others;
//              16 rising units: reversed signs
//   logits     idle is 0; charge takes falling units >= 0 and rising ones <= 0, discharge
//              with reversed signs
//
// So neither charge - idle nor idle - discharge can rise with price or SoC within these bounds.
// Rounding to integers keeps every sign, and the integer activations are monotone: the exported
// student has the property too.

/// Bounds of every parameter of a student, in the layout of mlp.h.
class SignBounds {
 public:
  /// No bounds.
  static SignBounds none();
  /// The bounds above, and bounds for further directions: if the action never falls with an input,
  /// falling units rise with it. Free units ignore inputs with a direction.
  static SignBounds monotone(const std::vector<Direction>& directions = RuleSet{}.directions());

  /// Flips the sign of parameters outside the bounds: keeps the magnitudes of the initial weights.
  void reflect(Parameters& parameters) const;
  /// Projects onto the bounds.
  void clamp(Parameters& parameters) const {
    parameters = parameters.cwiseMax(lower_).cwiseMin(upper_);
  }
  [[nodiscard]] bool contain(const Parameters& parameters) const {
    return (parameters.array() >= lower_.array()).all() &&
           (parameters.array() <= upper_.array()).all();
  }

 private:
  Parameters lower_, upper_;
};

// Rules in distillation. The teacher is unchanged. Actions that an operator's rule forbids are
// removed from the training states, and some states of every batch get hinge losses for all rules,
// built-in ones included. For a monotone student one or two corners of a rule's box suffice in each
// context.

/// State that decides a rule in its context, with the allowed actions.
struct ConstraintState {
  LatticeState state;
  ActionSet actions;
  std::size_t rule = 0;  ///< index in the set
};

/// Deciding states of the rules, for the hinge losses and for a quick check before a proof. Rules
/// that do not bind the student's states are omitted; directions are left to the sign bounds.
class RuleSamples {
 public:
  RuleSamples(const RuleSet& rules, ContextKind kind);

  [[nodiscard]] bool empty() const { return bound_rules_.empty(); }
  [[nodiscard]] std::size_t count() const { return bound_rules_.size(); }

  /// A deciding state of rule `index` < count(), in a context of its box; half of them in a context
  /// of `counterexamples`, if any.
  ConstraintState draw(std::size_t index, const std::vector<LatticeState>& counterexamples,
                       Random& random) const;

  /// Deciding states of a monotone student in this context; rules without corners are omitted.
  void corners(const LatticeState& context, std::vector<ConstraintState>& states) const;

  /// Actions that the operator's rules allow at a network input.
  [[nodiscard]] ActionSet actions_at(const float* x, const PriceMap& price_map) const;

 private:
  struct BoundRule {
    std::size_t index;  ///< in the set
    Rule rule;
    LatticeBox box;
    bool has_corners;  ///< false: any state of the box may be the worst
  };
  [[nodiscard]] bool holds(const BoundRule& bound_rule, const LatticeState& context) const;
  [[nodiscard]] LatticeState draw_context(const BoundRule& bound_rule, Random& random) const;
  static ConstraintState corner(const BoundRule& bound_rule, const LatticeState& context,
                                bool at_least);

  ContextKind kind_;
  std::vector<BoundRule> bound_rules_;
  ImpliedRanges implied_;
};

/// Saturation of a hidden unit; quantise_student() needs it.
inline constexpr double kSaturation = 1;

/// Training states with the teacher's values.
struct TrainingBatch {
  Matrix inputs;        ///< [5 x states]
  Matrix teacher_frac;  ///< [3 x states] softmax of the teacher's values
  Matrix regret;        ///< [3 x states] loss against the best action, over the temperature
};

/// Visited states and random states of the lattice. Where the teacher would violate one of the
/// options' rules, its best allowed action replaces its choice.
TrainingBatch make_training_states(const Teacher& teacher, const Matrix& visited,
                                   const DistilOptions& options);

class MonotoneDistiller {
 public:
  /// Keeps a reference: `batch` must outlive it. `options.correct` false: the same student and
  /// training without bounds, for comparison.
  MonotoneDistiller(const Teacher& teacher, const TrainingBatch& batch,
                    const DistilOptions& options);

  /// Trains for `epochs`; the rules are also trained in the states `counterexamples`. Calls `look`
  /// from time to time and at the end, with the share of epochs done.
  void run(int epochs, const std::vector<LatticeState>& counterexamples,
           const std::atomic<bool>& interrupted, const std::function<void(double done)>& look);

  [[nodiscard]] const Parameters& parameters() const { return average_; }
  [[nodiscard]] const std::vector<DistilPoint>& curve() const { return curve_; }

 private:
  struct Worker {
    Parameters gradient;
    double loss = 0;
    Matrix x, target, regret, a1, h1, a2, h2, z, dz, d1, d2;
    Eigen::Index learnt;             ///< columns that follow the teacher, then those for rules
    std::vector<ActionSet> allowed;  ///< of the columns for rules
  };

  void spread_activations();
  void draw_batch(const std::vector<LatticeState>& counterexamples, Worker& worker);
  void forward(const Parameters& parameters, Worker& worker) const;
  void learn(Worker& worker, double scale) const;

  const Teacher& teacher_;
  const TrainingBatch& batch_;
  DistilOptions options_;
  Random random_;
  RuleSamples rules_;
  SignBounds bounds_;
  Parameters student_;
  Parameters average_;  ///< running mean of the student's parameters, inside the bounds
  Adam adam_;
  ThreadTeam team_;
  std::vector<Worker> workers_;
  std::vector<DistilPoint> curve_;
};

}  // namespace bess
