#include "tools/simulators/battery_sim/simulated_battery.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "shared/local_time.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kMinuteNs = 60 * kNanosecondsPerSecond;
constexpr double kNanosecondsPerHour = 3.6e12;
constexpr double kThrottledFraction = 0.25;
constexpr double kThrottledSocFrac = 0.05;  ///< this close to a limit
constexpr double kForcedBelowFrac = 0.10;
constexpr double kForcedUntilFrac = 0.11;
constexpr double kFullFrac = 0.995;
constexpr std::int64_t kLagStepNs = kNanosecondsPerSecond / 20;
constexpr double kArrivedW = 0.5;  ///< an exponential never arrives

}  // namespace

SimulatedBattery::SimulatedBattery(const BatteryParameters& parameters, double soc_frac,
                                   std::int64_t utc_ns)
    : parameters_(parameters), soc_frac_(soc_frac), now_ns_(utc_ns) {}

void SimulatedBattery::advance(std::int64_t utc_ns) {
  while (now_ns_ < utc_ns) {
    std::int64_t end_ns = std::min(utc_ns, (now_ns_ / kMinuteNs + 1) * kMinuteNs);
    if (dispatch_active_) end_ns = std::min(end_ns, dispatch_end_ns_);
    if (now_ns_ < change_ns_) end_ns = std::min(end_ns, change_ns_);
    if (changes_by_the_second()) end_ns = std::min(end_ns, now_ns_ + kNanosecondsPerSecond);
    if (is_lagging()) end_ns = std::min(end_ns, now_ns_ + kLagStepNs);
    integrate_segment(end_ns);
    if (dispatch_active_ && now_ns_ >= dispatch_end_ns_) {
      dispatch_active_ = false;
      note(DispatchEvent::Kind::kExpiry);
    }
  }
}

void SimulatedBattery::integrate_segment(std::int64_t end_ns) {
  const double hours = static_cast<double>(end_ns - now_ns_) / kNanosecondsPerHour;
  if (hours > 0) {
    follow_habits(hours * 3'600);
    const double burnt_wh = burnt_w() * hours;
    const double wanted_w = wanted_power_w();
    const BatteryStep step = battery_step(limited(), soc_frac_, wanted_w, hours);
    if (step.power_w != wanted_w) {  // limited: continue from there; keep the direction of a ramp
      lagged_w_ = step.power_w;
      ramped_w_ =
          wanted_w > 0 ? std::min(ramped_w_, step.power_w) : std::max(ramped_w_, step.power_w);
    }
    minute_energy_wh_ += step.power_w * hours + burnt_wh;
    const double drained_frac = habits_.hidden_drain_w * hours / parameters_.capacity_wh;
    soc_frac_ = std::max(step.soc_frac - drained_frac, 0.0);
  }
  now_ns_ = end_ns;
  if (now_ns_ % kMinuteNs == 0 && hours > 0) {
    minutes_.push_back(current_minute());
    minutes_.back().minute_utc_s -= 60;
    minute_energy_wh_ = 0;
  }
}

bool SimulatedBattery::changes_by_the_second() const {
  return habits_.slows_near_limits || ramp_w_per_s() > 0 || habits_.forced_charge_w > 0 ||
         habits_.balancing_w > 0 || !has_constant_power(parameters_);
}

/// The slower of battery and habit; 0: immediate.
double SimulatedBattery::ramp_w_per_s() const {
  const double own = parameters_.response.ramp_w_per_s;
  if (own <= 0 || habits_.ramp_w_per_s <= 0) return std::max(own, habits_.ramp_w_per_s);
  return std::min(own, habits_.ramp_w_per_s);
}

bool SimulatedBattery::is_lagging() const {
  const double wanted_w = dispatch_active_ ? ordered_flow_w() : 0;
  return parameters_.response.time_constant_s > 0 &&
         (lagged_w_ != wanted_w || ramped_w_ != wanted_w);
}

/// Advances forced charging, ramp and lag by one segment.
void SimulatedBattery::follow_habits(double seconds) {
  if (soc_frac_ < kForcedBelowFrac) is_charging_itself_ = true;
  if (soc_frac_ >= kForcedUntilFrac || habits_.forced_charge_w == 0) is_charging_itself_ = false;
  const double reach_w = ramp_w_per_s() > 0 ? ramp_w_per_s() * seconds : INFINITY;
  const double wanted_w = dispatch_active_ ? ordered_flow_w() : 0;
  ramped_w_ = std::clamp(wanted_w, ramped_w_ - reach_w, ramped_w_ + reach_w);
  const double tau_s = parameters_.response.time_constant_s;
  const double kept = tau_s > 0 ? std::exp(-seconds / tau_s) : 0;
  const double left_w = (lagged_w_ - ramped_w_) * kept;
  lagged_w_ = std::abs(left_w) < kArrivedW ? ramped_w_ : ramped_w_ + left_w;
}

BatteryParameters SimulatedBattery::limited() const {
  BatteryParameters p = parameters_;
  p.power_w_max *= derating_;
  if (!dispatch_active_ || is_charging_itself_) return p;
  p.power_w_max *= std::max(habits_.gain, 1.0) * (1 + 5 * habits_.noise_frac);
  if (power_w_ == 0 && habits_.idle_power_w != 0) {
    p.soc_min_frac = 0;
    p.soc_max_frac = 1;
  }
  if (power_w_ > 0) p.soc_max_frac = std::min(p.soc_max_frac, soc_limit_frac_);
  if (power_w_ < 0) p.soc_min_frac = std::max(p.soc_min_frac, soc_limit_frac_);
  const double room_frac = power_w_ > 0 ? p.soc_max_frac - soc_frac_ : soc_frac_ - p.soc_min_frac;
  if (habits_.slows_near_limits && room_frac < kThrottledSocFrac) {
    p.power_w_max *= kThrottledFraction;
  }
  return p;
}

double SimulatedBattery::wanted_power_w() const {
  if (is_charging_itself_) return habits_.forced_charge_w;
  if (!dispatch_active_) return 0;
  if (parameters_.response.time_constant_s > 0) return lagged_w_;
  return ramp_w_per_s() > 0 ? ramped_w_ : ordered_flow_w();
}

/// Power at the grid side that does not reach the cells.
double SimulatedBattery::burnt_w() const {
  const bool is_full = soc_frac_ >= kFullFrac * parameters_.soc_max_frac;
  return parameters_.standby_w + (is_full && commanded_power_w() >= 0 ? habits_.balancing_w : 0);
}

double SimulatedBattery::ordered_flow_w() const {
  const double ordered_w = now_ns_ < change_ns_ ? power_before_w_ : power_w_;
  if (ordered_w == 0) return habits_.idle_power_w;
  const double flow_w = ordered_w * habits_.gain * noise_factor();
  if (!parameters_.cold.exist()) return flow_w;
  const double most_w = parameters_.power_w_max * cold_share();
  return std::clamp(flow_w, -most_w, most_w);
}

/// Share of the power available in cold hours, by local time.
double SimulatedBattery::cold_share() const {
  if (!parameters_.cold.exist()) return 1;
  return parameters_.cold.share_at(local_minute_of(now_ns_ / kNanosecondsPerSecond).quarter_hour);
}

/// Constant within a minute.
double SimulatedBattery::noise_factor() const {
  if (habits_.noise_frac == 0) return 1;
  std::minstd_rand random(static_cast<unsigned>(now_ns_ / kMinuteNs));
  random.discard(8);
  return std::normal_distribution<>(1, habits_.noise_frac)(random);
}

void SimulatedBattery::start_dispatch(double power_w, double soc_limit_frac,
                                      std::int64_t duration_s) {
  if (power_w != commanded_power_w()) {
    power_before_w_ = commanded_power_w();
    change_ns_ = now_ns_ + std::llround((habits_.delay_s + parameters_.response.delay_s) * 1e9);
  }
  dispatch_active_ = duration_s > 0;
  power_w_ = power_w;
  soc_limit_frac_ = soc_limit_frac;
  dispatch_end_ns_ = now_ns_ + duration_s * kNanosecondsPerSecond;
  note(DispatchEvent::Kind::kOrder, power_w, duration_s);
}

void SimulatedBattery::stop_dispatch() {
  if (dispatch_active_) note(DispatchEvent::Kind::kStop);
  dispatch_active_ = false;
}

void SimulatedBattery::note(DispatchEvent::Kind kind, double power_w, std::int64_t duration_s) {
  events_.push_back({.utc_ns = now_ns_,
                     .kind = kind,
                     .power_w = power_w,
                     .duration_s = duration_s,
                     .soc_frac = soc_frac_});
}

double SimulatedBattery::power_w() const {
  constexpr double kOneSecondHours = 1.0 / 3'600.0;
  return battery_step(limited(), soc_frac_, wanted_power_w(), kOneSecondHours).power_w + burnt_w();
}

MinuteRecord SimulatedBattery::current_minute() const {
  return {.minute_utc_s = now_ns_ / kMinuteNs * 60,
          .energy_wh = minute_energy_wh_,
          .soc_frac = soc_frac_,
          .commanded_power_w = commanded_power_w()};
}

std::vector<MinuteRecord> SimulatedBattery::record() const {
  std::vector<MinuteRecord> all = minutes_;
  if (now_ns_ % kMinuteNs != 0) all.push_back(current_minute());
  return all;
}

}  // namespace bess
