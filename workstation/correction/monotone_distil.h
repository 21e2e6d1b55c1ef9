// Distillation into a student that is monotone by construction (sign_bounds.h). Nothing of property
// 3 is left to training, so training has one aim, what the student earns:
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

#include "workstation/correction/distil.h"
#include "workstation/correction/rule_lessons.h"
#include "workstation/correction/sign_bounds.h"

namespace bess {

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
