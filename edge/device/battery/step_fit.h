// Step fit: dead time, time constant and ramp of a battery from steps of different size. A
// first-order lag takes the same time for any step, a ramp takes longer for a larger one. One step
// alone cannot separate them; the ambiguity widens the result.
//
//   risen(t) = (1/T) (ramp of `ramp_w_per_s` * lag of time constant T)(t - dead time)
//
// Least squares over all steps, for each ramp from none to the slowest (a profile). Every fit
// nearly as good as the best is possible: the time of a step is given as the minimum, best and
// maximum of these.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "edge/core/base/static_vector.h"

namespace bess {

// Response curve: readings since the order, the time at which the power had settled, and the time
// until which it had not. A reading takes time, and the program may be delayed within it; "slow"
// must hold for any instant within the reading.

struct StepReading {
  std::int64_t begin_ms = 0;  ///< since the order came into force
  std::int64_t end_ms = 0;
  std::int32_t along_w = 0;  ///< positive: in the ordered direction
};

class StepResponse {
 public:
  using Readings = StaticVector<StepReading, 256>;

  /// `ordered_w` above 0 and above the initial `from_w` (below 0: other direction); within `band_w`
  /// of it the power has settled.
  StepResponse(std::int32_t ordered_w, std::int32_t band_w, std::int32_t from_w = 0)
      : ordered_w_(ordered_w), band_w_(band_w), from_w_(from_w) {}

  /// Readings beyond the capacity are dropped: the first ones show the shape.
  void add(const StepReading& reading) {
    if (!is_within(reading.along_w)) {
      outside_until_ms_ = reading.begin_ms;
      came_ms_ = -1;
    } else if (came_ms_ < 0) {
      came_ms_ = reading.end_ms;
    }
    static_cast<void>(readings_.try_push_back(reading));
  }

  [[nodiscard]] const Readings& readings() const { return readings_; }
  [[nodiscard]] std::int32_t step_w() const { return ordered_w_ - from_w_; }
  [[nodiscard]] std::int32_t band_w() const { return band_w_; }
  /// Rise since the start of the step.
  [[nodiscard]] std::int32_t risen_w(const StepReading& r) const { return r.along_w - from_w_; }
  /// The last instant at which the power was certainly outside its band.
  [[nodiscard]] std::int64_t outside_until_ms() const { return outside_until_ms_; }
  [[nodiscard]] bool has_come() const { return came_ms_ >= 0; }
  /// First time of the final stay within the band; -1: never.
  [[nodiscard]] std::int64_t came_ms() const { return came_ms_; }

  /// The last quarter of the readings still rises: slow, not limited.
  [[nodiscard]] bool is_rising() const {
    const int quarter = readings_.size() / 4;
    if (quarter == 0) return false;
    std::int64_t rise_w = 0;
    for (int i = readings_.size() - quarter; i < readings_.size(); ++i) {
      rise_w += std::int64_t{readings_[i].along_w} - readings_[i - quarter].along_w;
    }
    return rise_w * 100 >= std::int64_t{step_w()} * quarter * kRisePercent;
  }
  /// Longest constant value during the rise: registers with a slow update.
  [[nodiscard]] std::int64_t stands_still_ms() const {
    std::int64_t longest_ms = 0;
    const StepReading* first = nullptr;
    for (const StepReading& r : readings_) {
      const bool is_on_its_way = !is_within(r.along_w) && risen_w(r) * 10 >= step_w();
      if (!is_on_its_way || first == nullptr || first->along_w != r.along_w) first = &r;
      if (is_on_its_way) longest_ms = std::max(longest_ms, r.end_ms - first->begin_ms);
    }
    return longest_ms;
  }
  [[nodiscard]] int readings_outside_after(std::int64_t ms) const {
    int count = 0;
    for (const StepReading& r : readings_) {
      if (r.begin_ms > ms && !is_within(r.along_w)) ++count;
    }
    return count;
  }

 private:
  static constexpr std::int32_t kRisePercent = 3;

  [[nodiscard]] bool is_within(std::int32_t along_w) const {
    return along_w >= ordered_w_ - band_w_ && along_w <= ordered_w_ + band_w_;
  }

  std::int32_t ordered_w_;
  std::int32_t band_w_;
  std::int32_t from_w_;
  Readings readings_;
  std::int64_t outside_until_ms_ = 0;
  std::int64_t came_ms_ = -1;
};

struct StepDynamics {
  double dead_time_s = 0;
  double time_constant_s = 0;
  double ramp_s_per_w = 0;  ///< 0: none
};

/// Rise of a step of `step_w` after `seconds`.
double step_response_w(const StepDynamics& dynamics, double step_w, double seconds);
/// Time until at most `left_w` of it is missing.
double seconds_until(const StepDynamics& dynamics, double step_w, double left_w);

struct SecondsOfStep {
  double least = 0;
  double best = 0;
  double most = 0;
};

class StepFit {
 public:
  /// Curves of one battery, in any direction; at least one; they must outlive this object.
  explicit StepFit(std::span<const StepResponse* const> curves);

  [[nodiscard]] const StepDynamics& best() const { return best_; }
  /// The readings cannot be explained without a ramp.
  [[nodiscard]] bool has_ramp() const { return has_ramp_; }
  [[nodiscard]] SecondsOfStep seconds_until(double step_w, double left_w) const;

 private:
  template <typename See>
  void profile(See see) const;
  void refine(double& least);
  template <typename See>
  void descend(StepDynamics& from, bool looks_around, See see) const;
  [[nodiscard]] double misfit(const StepDynamics& dynamics) const;

  std::span<const StepResponse* const> curves_;
  StepDynamics best_;
  double misfit_max_ = 0;  ///< maximum misfit of a possible fit
  bool has_ramp_ = false;
};

}  // namespace bess
