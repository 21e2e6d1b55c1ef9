#include "edge/device/battery/commission_types.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "edge/device/battery/step_fit.h"

namespace bess {

namespace {

constexpr int kReadingsLate = 3;  ///< noise causes fewer
/// Margin of a proposed setting.
constexpr double kSpare = 1.2;
constexpr std::int32_t kStepToW = 100;

/// Time error of a reading: its duration, and the age of its registers.
double unknown_s(const StepResponse& curve) {
  std::int64_t longest_ms = 0;
  for (const StepReading& r : curve.readings()) {
    longest_ms = std::max(longest_ms, r.end_ms - r.begin_ms);
  }
  return static_cast<double>(longest_ms + curve.stands_still_ms()) / 2'000;
}

bool is_late(const StepResponse& curve, double settle_s) {
  return curve.readings_outside_after(std::lround(settle_s * 1e3)) >= kReadingsLate;
}

/// A measurement of the largest step itself overrides the model.
void limit_to_observed(const StepResponse& curve, SecondsOfStep& seconds) {
  if (!curve.has_come()) return;
  const double came_s = static_cast<double>(curve.came_ms()) / 1e3;
  seconds.least = std::min(seconds.least, came_s);
  seconds.most = std::max(seconds.least, std::min(seconds.most, came_s));
  seconds.best = std::clamp(seconds.best, seconds.least, seconds.most);
}

/// The largest step certainly within the maximum of a map: with a ramp, smaller steps are faster.
std::int32_t manageable_step_w(const StepFit& fit, const StepResponseCriteria& criteria) {
  std::int32_t low_w = 0;
  std::int32_t high_w = criteria.step_w_max;
  while (high_w - low_w > kStepToW) {
    const std::int32_t middle_w = low_w + (high_w - low_w) / 2;
    const bool is_within =
        fit.seconds_until(middle_w, criteria.band_w(middle_w)).most <= kSettleSMax / kSpare;
    std::int32_t& bound_w = is_within ? low_w : high_w;
    bound_w = middle_w;
  }
  return low_w / kStepToW * kStepToW;
}

/// Proposes at least the observed time.
void propose(const StepResponse& small, const StepResponse& larger, const StepFit& fit,
             const StepResponseCriteria& criteria, StepResponseResult& speed) {
  const std::int64_t seen_ms = std::max(small.outside_until_ms(), larger.outside_until_ms());
  const double needed_s = std::max(speed.has_two ? speed.largest.most : speed.largest.least,
                                   static_cast<double>(seen_ms) / 1e3);
  const double wanted_s = std::floor(needed_s * kSpare) + 1;
  speed.wanted_settle_s = static_cast<std::int32_t>(std::min<double>(wanted_s, kSettleSMax));
  if (speed.largest.best > kSettleSMax / kSpare && wanted_s > kSettleSMax) {
    speed.wanted_ramp_w_max = manageable_step_w(fit, criteria);
  }
}

SecondsOfStep largest_step(const StepFit& fit, const StepResponse& larger,
                           const StepResponseCriteria& criteria) {
  const std::int32_t step_w = criteria.step_w_max;
  const std::int32_t band_w = criteria.band_w(step_w);
  const double error_s =
      unknown_s(larger) * std::max(1.0, static_cast<double>(step_w) / larger.step_w());
  SecondsOfStep seconds = fit.seconds_until(step_w, band_w);
  seconds.least = std::max(seconds.least - error_s, 0.0);
  seconds.most += error_s;
  if (larger.step_w() >= step_w - band_w) limit_to_observed(larger, seconds);
  return seconds;
}

}  // namespace

StepResponseResult judge_speed(const StepResponse& small, const StepResponse* large,
                               const StepResponseCriteria& criteria) {
  StepResponseResult speed;
  speed.has_two = large != nullptr && large->step_w() >= 2 * small.step_w();
  const StepResponse& larger = speed.has_two ? *large : small;
  const StepResponse* const curves[] = {&small, large};
  const StepFit fit(std::span(curves, speed.has_two ? 2 : 1));
  speed.largest = largest_step(fit, larger, criteria);
  speed.dynamics = fit.best();
  if (!fit.has_ramp()) speed.dynamics.ramp_s_per_w = 0;

  const double settle_s = criteria.response.settle_s;
  // A single step is evidence only of its own time.
  const double surely_s =
      speed.has_two ? speed.largest.least
                    : fit.seconds_until(small.step_w(), small.band_w()).least - unknown_s(small);
  speed.is_slow = surely_s > settle_s || is_late(small, settle_s) || is_late(larger, settle_s);
  speed.is_doubtful = !speed.is_slow && speed.largest.most > settle_s;
  if (speed.is_slow) propose(small, larger, fit, criteria, speed);
  return speed;
}

}  // namespace bess
