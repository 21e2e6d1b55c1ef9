// Dead time, time constant and ramp of a battery, told apart by steps of different size: a
// first-order lag takes as long for any step, a ramp longer the larger it is. One step alone cannot
// tell them; what it leaves open is the width of what follows.
//
//   risen(t) = (1/T) (ramp of `ramp_w_per_s` * lag of time constant T)(t - dead time)
//
// Least squares over all steps at once, for each ramp from none to the slowest (a profile). All
// that fits nearly as well as the best is held possible: how long a step takes is told as the
// least, the best and the most of those.
#pragma once

#include <cstdint>
#include <span>

#include "edge/battery/answer_curve.h"

namespace bess {

struct StepDynamics {
  double dead_time_s = 0;
  double time_constant_s = 0;
  double ramp_s_per_w = 0;  ///< 0: none
};

/// Of a step of `step_w` what has come after `seconds`.
double risen_w(const StepDynamics& dynamics, double step_w, double seconds);
/// Until no more than `left_w` of it is missing.
double seconds_until(const StepDynamics& dynamics, double step_w, double left_w);

struct SecondsOfStep {
  double least = 0;
  double best = 0;
  double most = 0;
};

class StepFit {
 public:
  /// Of the same battery, in the same direction or not; one at least, and they outlive this.
  explicit StepFit(std::span<const AnswerCurve* const> curves);

  [[nodiscard]] const StepDynamics& best() const { return best_; }
  /// What was read cannot be explained without one.
  [[nodiscard]] bool has_ramp() const { return has_ramp_; }
  [[nodiscard]] SecondsOfStep seconds_until(double step_w, double left_w) const;

 private:
  template <typename See>
  void profile(See see) const;
  void refine(double& least);
  template <typename See>
  void descend(StepDynamics& from, bool looks_around, See see) const;
  [[nodiscard]] double misfit(const StepDynamics& dynamics) const;

  std::span<const AnswerCurve* const> curves_;
  StepDynamics best_;
  double misfit_max_ = 0;  ///< of what is held possible
  bool has_ramp_ = false;
};

}  // namespace bess
