#include "edge/device/battery/step_fit.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

/// From none, then from 20 kW/s to 2 W/s, each 15 % slower.
constexpr double kQuickestSPerW = 1.0 / 20'000;
constexpr double kSlowestSPerW = 1.0 / 2;
constexpr double kSlowerBy = 1.15;
constexpr double kFinerBy = 1.02;
/// Error of one reading, and of the model.
constexpr double kErrorW = 8;
constexpr double kErrorFrac = 0.01;
/// Permitted difference between final power and order.
constexpr double kGainErrorFrac = 0.05;
/// Three standard deviations of one parameter; a single step has twice the range.
constexpr double kPossibleMisfit = 9;
constexpr double kPossibleMisfitOfOne = 36;
constexpr double kFinestS = 0.02;
constexpr int kLookAroundEvery = 8;  ///< ramps: a good fit is near that of the next ramp
constexpr int kParameters = 3;

}  // namespace

double step_response_w(const StepDynamics& d, double step_w, double seconds) {
  const double t = seconds - d.dead_time_s;
  if (t <= 0) return 0;
  const double ramp_s = step_w * d.ramp_s_per_w;
  const double on_ramp_s = std::min(t, ramp_s);
  const double ramped_w = ramp_s > 0 ? step_w * on_ramp_s / ramp_s : step_w;
  if (d.time_constant_s <= 0) return ramped_w;
  const double share = d.time_constant_s / std::max(ramp_s, 1e-9);  // behind the ramp
  const double behind_w =
      ramp_s > 0 ? step_w * share * -std::expm1(-on_ramp_s / d.time_constant_s) : step_w;
  return ramped_w - behind_w * std::exp(-(t - on_ramp_s) / d.time_constant_s);
}

double seconds_until(const StepDynamics& d, double step_w, double left_w) {
  double low_s = d.dead_time_s;
  double high_s = low_s + step_w * d.ramp_s_per_w + 20 * d.time_constant_s;
  while (high_s - low_s > kFinestS) {
    const double middle_s = (low_s + high_s) / 2;
    const bool is_too_early = step_response_w(d, step_w, middle_s) < step_w - left_w;
    double& bound_s = is_too_early ? low_s : high_s;
    bound_s = middle_s;
  }
  return high_s;
}

StepFit::StepFit(std::span<const StepResponse* const> curves) : curves_(curves) {
  double least = INFINITY;
  double least_without_ramp = INFINITY;
  profile([&](const StepDynamics& d, double misfit) {
    if (d.ramp_s_per_w == 0) least_without_ramp = std::min(least_without_ramp, misfit);
    if (misfit >= least) return;
    least = misfit;
    best_ = d;
  });
  refine(least);
  int readings = 0;
  for (const StepResponse* curve : curves_) readings += curve->readings().size();
  const double variance = std::max(least / std::max(readings - kParameters, 1), 1.0);
  misfit_max_ = least + (curves_.size() > 1 ? kPossibleMisfit : kPossibleMisfitOfOne) * variance;
  has_ramp_ = least_without_ramp > misfit_max_;
}

SecondsOfStep StepFit::seconds_until(double step_w, double left_w) const {
  const double best_s = bess::seconds_until(best_, step_w, left_w);
  SecondsOfStep seconds{.least = best_s, .best = best_s, .most = best_s};
  profile([&](const StepDynamics& d, double misfit) {
    if (misfit > misfit_max_) return;
    const double possible_s = bess::seconds_until(d, step_w, left_w);
    seconds.least = std::min(seconds.least, possible_s);
    seconds.most = std::max(seconds.most, possible_s);
  });
  return seconds;
}

/// Refines between two ramps of the profile.
void StepFit::refine(double& least) {
  const double ramp_s_per_w = best_.ramp_s_per_w;
  for (double by = 1 / kSlowerBy; by < kSlowerBy; by *= kFinerBy) {
    StepDynamics from = best_;
    from.ramp_s_per_w = ramp_s_per_w * by;
    descend(from, false, [&](const StepDynamics& d, double misfit) {
      if (misfit >= least) return;
      least = misfit;
      best_ = d;
    });
  }
}

/// Passes every candidate to `see`, including those around the minimum.
template <typename See>
void StepFit::profile(See see) const {
  StepDynamics from{};
  int ramps = 0;
  for (double ramp_s_per_w = 0; ramp_s_per_w < kSlowestSPerW;
       ramp_s_per_w = std::max(ramp_s_per_w * kSlowerBy, kQuickestSPerW)) {
    from.ramp_s_per_w = ramp_s_per_w;
    descend(from, ramps++ % kLookAroundEvery == 0, see);
  }
}

/// Starts at the previous ramp's best, and regularly at a coarse grid, with decreasing steps. Dead
/// time and time constant are hard to separate, their sum is not: one step changes the sum, another
/// keeps it. Without a time constant only the dead time can reduce the sum.
template <typename See>
void StepFit::descend(StepDynamics& from, bool looks_around, See see) const {
  double least = misfit(from);
  see(from, least);
  const auto try_one = [&](double dead_time_s, double time_constant_s) {
    const StepDynamics d{.dead_time_s = std::max(dead_time_s, 0.0),
                         .time_constant_s = std::max(time_constant_s, 0.0),
                         .ramp_s_per_w = from.ramp_s_per_w};
    const double its = misfit(d);
    see(d, its);
    if (its >= least) return false;
    least = its;
    from = d;
    return true;
  };
  for (const double seconds : {0.0, 1.0, 4.0, 16.0, 64.0}) {
    if (!looks_around) break;
    for (const double share : {0.0, 0.5, 1.0}) try_one(seconds * (1 - share), seconds * share);
  }
  for (double step_s = 4; step_s > kFinestS;) {
    const double dead_s = from.dead_time_s;
    const double constant_s = from.time_constant_s;
    const bool is_better = try_one(dead_s, constant_s + step_s) ||
                           try_one(dead_s, constant_s - step_s) ||
                           try_one(dead_s + step_s, constant_s - step_s) ||
                           try_one(dead_s - step_s, constant_s + step_s) ||
                           (constant_s == 0 && try_one(dead_s - step_s, 0));
    if (!is_better) step_s /= 2;
  }
}

/// Uses the best gain, with a prior near 1.
double StepFit::misfit(const StepDynamics& dynamics) const {
  double sum = 0;
  for (const StepResponse* curve : curves_) {
    const double step_w = curve->step_w();
    const double error_w = kErrorW + kErrorFrac * step_w;
    const double weight = 1 / (error_w * error_w);
    double both = 1 / (kGainErrorFrac * kGainErrorFrac);
    double model = both;
    double read = both;
    for (const StepReading& r : curve->readings()) {
      const double seconds = static_cast<double>(r.begin_ms + r.end_ms) / 2'000;
      const double model_w = step_response_w(dynamics, step_w, seconds);
      const double read_w = curve->risen_w(r);
      both += weight * model_w * read_w;
      model += weight * model_w * model_w;
      read += weight * read_w * read_w;
    }
    sum += read - both * both / model;
  }
  return sum;
}

}  // namespace bess
