// Distillation into a student that is monotone by construction: its weights keep sign bounds. No
// part of property 3 is left to training, so training has one aim, what the student earns:
//
//   L = fidelity KL(mu || pi') + E_pi'[regret] / temperature   mu = softmax(values / temperature)
//
// over states that the teacher visits and some from anywhere, with hinges where a rule binds,
// built-in (properties 1 and 2) or an operator's: by monotony a state or two for each context tell.
// Hidden activations saturate at 0 and at 1, so that sums of them bend both ways.
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
#include "workstation/policy/rl/price_map.h"

namespace bess {

// A student that is monotone by construction [SPEC 5, property 3]: which weights may have which
// sign, in the student's own 5-64-32-3. Monotone networks are Sill (1998) and Daniels and Velikova
// (2010); units that fall and units that rise side by side, and free ones for the inputs without an
// order, are what Runje and Shankaranarayana (2023) call a constrained monotone network.
//
//   hidden 1   20 units fall with price and SoC (weights <= 0), 20 rise (>= 0), 24 do not see them;
//              time and context enter all of them freely
//   hidden 2   16 falling units: weights >= 0 from falling, <= 0 from rising, free from the others;
//              16 rising units: the other way round
//   logits     idle is the origin; charge takes falling units >= 0 and rising ones <= 0, discharge
//              the other way round
//
// So neither charge - idle nor idle - discharge can rise with price or SoC, whatever the weights
// are inside these bounds. Rounding to integers keeps every sign, and the integer activations rise
// with their sums: the exported student has the property too.

/// Bounds of every parameter of a student, in the layout of mlp.h.
class SignBounds {
 public:
  /// No bound at all.
  static SignBounds none();
  /// The bounds above, and the same for other inputs: where the action never falls with one,
  /// falling units rise with it. Free units see no input that has a direction.
  static SignBounds monotone(const std::vector<Direction>& directions = RuleSet{}.directions());

  /// Turns the sign of what lies outside: a start inside with as many weights that matter.
  void reflect(Parameters& parameters) const;
  /// To the nearest parameters inside.
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

// How a student learns rules while it is distilled, the teacher untouched: what the teacher would
// do against an operator's rule is taken out of the lessons, and some states of every batch are
// held to every rule, the built-in ones too, by hinges. Of a monotone student one or two corners of
// a rule's box tell for all of it, in each context.

/// A state that decides a rule in its context, and what is allowed there.
struct HardState {
  LatticeState state;
  ActionSet actions;
  std::size_t rule = 0;  ///< index in the set
};

/// Which states of a rule decide it, for the hinges and for a quick look before a proof. Rules that
/// do not bind the student's states are left out; a direction is the signs' (monotone_distil.h).
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

/// Where a hidden unit saturates; quantise_student() must know it.
inline constexpr double kSaturation = 1;

/// States to learn from, with what the teacher would do in each.
struct LessonStates {
  Matrix inputs;        ///< [5 x states]
  Matrix teacher_frac;  ///< [3 x states] softmax of the teacher's values
  Matrix regret;  ///< [3 x states] what an action loses against the best, over the temperature
};

/// Visited states and, for what no day has shown, states from anywhere in the lattice. Where the
/// teacher would break one of the options' rules, its next best takes its place.
LessonStates make_lessons(const Teacher& teacher, const Matrix& visited,
                          const DistilOptions& options);

class MonotoneDistiller {
 public:
  /// Keeps a reference: `lessons` must outlive it. `options.correct` false: the same student and
  /// training without any bound, for comparison.
  MonotoneDistiller(const Teacher& teacher, const LessonStates& lessons,
                    const DistilOptions& options);

  /// Trains for `epochs`; `counterexamples` are states that the rules must be learnt in, besides
  /// random ones. Calls `look` now and then, at the end for certain, with the share of epochs done.
  void run(int epochs, const std::vector<LatticeState>& counterexamples,
           const std::atomic<bool>& interrupted, const std::function<void(double done)>& look);

  [[nodiscard]] const Parameters& parameters() const { return average_; }
  [[nodiscard]] const std::vector<DistilPoint>& curve() const { return curve_; }

 private:
  struct Worker {
    Parameters gradient;
    double loss = 0;
    Matrix x, target, regret, a1, h1, a2, h2, z, dz, d1, d2;
    Eigen::Index learnt;             ///< columns that follow the teacher; the others obey the rules
    std::vector<ActionSet> allowed;  ///< of those others
  };

  void spread_activations();
  void draw_batch(const std::vector<LatticeState>& counterexamples, Worker& worker);
  void forward(const Parameters& parameters, Worker& worker) const;
  void learn(Worker& worker, double scale) const;

  const Teacher& teacher_;
  const LessonStates& lessons_;
  DistilOptions options_;
  Random random_;
  RuleLessons rules_;
  SignBounds bounds_;
  Parameters student_;
  Parameters average_;  ///< of the student on its way, inside the bounds with it
  Adam adam_;
  ThreadTeam team_;
  std::vector<Worker> workers_;
  std::vector<DistilPoint> curve_;
};

}  // namespace bess
