#include "tests/system/trial/trial_battery.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/units_and_limits.h"

namespace bess::trial {
namespace {

constexpr double kSecondsPerHour = 3'600;
constexpr std::int64_t kAnswerNs = 50'000'000;
constexpr double kTimeOutS = 3;
constexpr double kCreep = 0.005 / 60;  ///< of the count at the ends, a second
constexpr std::int64_t kRestUntilCalibratedS = 600;

std::int32_t to_watts(double power_w) { return static_cast<std::int32_t>(std::lround(power_w)); }

}  // namespace

TrialBattery::TrialBattery(TrialClock& clock, const BatteryNature& nature, double soc_frac,
                           std::uint64_t seed)
    : clock_(clock),
      nature_(nature),
      random_(seed),
      now_s_(clock.true_utc_s()),
      charge_frac_(soc_frac),
      count_error_frac_(0) {
  if (nature_.restarts_per_day > 0) next_restart_s_ = now_s_ + kSecondsPerDay / 8;
  show();
}

Status TrialBattery::read(BatteryMeasurement& measurement) {
  clock_.now_ns += kAnswerNs;
  if (answers_late()) return Status::kTimeout;
  advance();
  if (now_s_ < back_s_) return Status::kTimeout;
  measurement = shown_;
  // The read-back equals the write, whatever its measurements do.
  measurement.dispatch_active = is_dispatched_;
  measurement.has_order_power = true;
  measurement.order_power_w = to_watts(ordered_w_);
  return Status::kOk;
}

Status TrialBattery::order(const PowerOrder& order) {
  clock_.now_ns += kAnswerNs;
  const bool is_late = answers_late();
  advance();
  if (now_s_ < back_s_) return Status::kTimeout;
  if (order.power_w != ordered_w_ || !is_dispatched_) {
    ordered_before_w_ = is_dispatched_ ? ordered_w_ : 0;
    ordered_s_ = now_s_;
  }
  is_dispatched_ = true;
  ordered_w_ = order.power_w;
  floor_frac_ = order.soc_min_e4 / 1e4;
  ceiling_frac_ = order.soc_max_e4 / 1e4;
  dispatch_end_s_ = now_s_ + order.duration_s;
  return is_late ? Status::kTimeout : Status::kOk;  // it has obeyed nevertheless
}

Status TrialBattery::release() {
  clock_.now_ns += kAnswerNs;
  advance();
  if (now_s_ < back_s_) return Status::kTimeout;
  is_dispatched_ = false;
  ordered_w_ = 0;
  return Status::kOk;
}

bool TrialBattery::answers_late() {
  if (nature_.late_per_answer == 0) return false;
  if (std::uniform_real_distribution<>(0, 1)(random_) >= nature_.late_per_answer) return false;
  const double late_s = nature_.late_s * std::uniform_real_distribution<>(0, 2)(random_);
  clock_.now_ns += static_cast<std::int64_t>(std::min(late_s, kTimeOutS) * 1e9);
  return late_s >= kTimeOutS;
}

void TrialBattery::advance() {
  while (now_s_ < clock_.true_utc_s()) step();
}

/// One second.
void TrialBattery::step() {
  ++now_s_;
  restart_at_times();
  if (is_dispatched_ && now_s_ >= dispatch_end_s_) {
    is_dispatched_ = false;
    ordered_w_ = 0;
  }
  follow_command();
  const bool is_faulty = this->is_faulty();
  if (is_faulty && !was_faulty_) note_fault_begin();
  was_faulty_ = is_faulty;
  flow_w_ = honest_w_;
  if (is_faulty && fault_->flow != nullptr) {
    flow_w_ = fault_->flow({.ordered_w = ordered_w_,
                            .ordered_before_w = ordered_before_w_,
                            .ordered_at_fault_w = ordered_at_fault_w_,
                            .order_age_s = now_s_ - ordered_s_,
                            .honest_w = honest_w_,
                            .rated_w = nature_.rated_w,
                            .now_s = now_s_});
    if (flow_w_ > 0 && charge_frac_ >= 1) flow_w_ = 0;
    if (flow_w_ < 0 && charge_frac_ <= 0) flow_w_ = 0;
  }
  account();
  count_charge();
  if (nature_.refresh_s == 0 || now_s_ % nature_.refresh_s == 0) show();
}

void TrialBattery::restart_at_times() {
  if (now_s_ < next_restart_s_) return;
  back_s_ = now_s_ + static_cast<std::int64_t>(nature_.restart_s);
  is_dispatched_ = false;
  ordered_w_ = target_w_ = stage_w_ = 0;
  const double mean_s = kSecondsPerDay / nature_.restarts_per_day;
  next_restart_s_ =
      back_s_ + static_cast<std::int64_t>(std::exponential_distribution<>(1 / mean_s)(random_));
}

double TrialBattery::hour_of_day() const {
  return static_cast<double>(now_s_ % kSecondsPerDay) / kSecondsPerHour;
}

double TrialBattery::sun_w() const {
  const double height = std::sin((hour_of_day() - 6) * std::numbers::pi / 12);
  const double clouds = 0.6 + 0.4 * std::sin(static_cast<double>(now_s_) / 400);
  return std::max(height, 0.0) * clouds * nature_.pv_peak_w;
}

/// Without an order. Some cover the load of their house, and take the rest of its sun.
double TrialBattery::own_mode_w() const {
  if (!nature_.follows_house) return 0;
  const double morning_and_evening = std::sin((hour_of_day() - 1) * std::numbers::pi / 6);
  const double house_w = 500 + 700 * std::max(morning_and_evening, 0.0);
  const double roof_w =
      3'000 * std::max(std::sin((hour_of_day() - 6) * std::numbers::pi / 12), 0.0);
  return roof_w - house_w;
}

double TrialBattery::command_w() const { return is_dispatched_ ? ordered_w_ : own_mode_w(); }

/// Lag, ramp and noise of the power stage, and the limits of the cells.
void TrialBattery::follow_command() {
  const double wanted_w = now_s_ < back_s_ ? 0 : command_w();
  if (wanted_w != followed_w_) {
    if (is_dispatched_) followed_from_s_ = now_s_ + static_cast<std::int64_t>(nature_.lag_s);
    followed_w_ = wanted_w;
  }
  if (now_s_ >= followed_from_s_) target_w_ = followed_w_;
  stage_w_ += std::clamp(target_w_ - stage_w_, -nature_.ramp_w_per_s, nature_.ramp_w_per_s);
  constexpr double kKept = 0.9;
  const double fresh = std::normal_distribution<>(0, nature_.noise_frac)(random_);
  wander_ = kKept * wander_ + std::sqrt(1 - kKept * kKept) * fresh;
  const double sun = now_s_ < back_s_ ? 0 : sun_w();
  honest_w_ = overridden_w(within_limits(stage_w_ * (1 + wander_) + sun));
}

double TrialBattery::counted_frac() const {
  return std::clamp(charge_frac_ + count_error_frac_ + surface_frac_, 0.0, 1.0);
}

double TrialBattery::temperature_c() const {
  if (!nature_.is_cold) return 20;
  return 7 + 5 * std::sin((hour_of_day() - 9) * std::numbers::pi / 12);
}

double TrialBattery::derated_w() const {
  const bool is_hot = hour_of_day() >= 12 && hour_of_day() < 15;
  return nature_.rated_w * (is_hot ? nature_.derating_frac : 1);
}

double TrialBattery::charge_limit_w() const {
  const double counted = counted_frac();
  if (charge_frac_ >= 1 || counted >= ceiling_frac_) return 0;
  double limit_w = derated_w();
  if (nature_.is_cold && temperature_c() < 8) limit_w = std::min(limit_w, 0.2 * nature_.rated_w);
  const double room = (1 - counted) / (1 - nature_.taper_from_frac);
  return limit_w * std::clamp(room, 0.08, 1.0);
}

double TrialBattery::discharge_limit_w() const {
  const double counted = counted_frac();
  if (charge_frac_ <= 0 || (is_dispatched_ && counted <= floor_frac_)) return 0;
  return derated_w() * std::clamp(counted / nature_.taper_below_frac, 0.3, 1.0);
}

double TrialBattery::within_limits(double power_w) const {
  return std::clamp(power_w, -discharge_limit_w(), charge_limit_w());
}

/// Actions of its management, independent of the order.
double TrialBattery::overridden_w(double power_w) {
  if (now_s_ < back_s_) return 0;
  const double counted = counted_frac();
  if (nature_.forced_charge_below_frac > 0) {
    if (counted < nature_.forced_charge_below_frac) is_forced_ = true;
    if (counted >= nature_.forced_charge_until_frac) is_forced_ = false;
    if (is_forced_) {
      return std::max(power_w, nature_.forced_charge_w);
    }
  }
  const bool is_balancing =
      nature_.balancing_w > 0 && counted >= 0.995 && power_w >= 0 && now_s_ / 600 % 2 == 0;
  if (is_balancing) {
    return nature_.balancing_w;
  }
  return power_w;
}

void TrialBattery::account() {
  const double hours = 1 / kSecondsPerHour;
  energy_.moved_wh += std::abs(flow_w_) * hours;
  const double beyond_w = std::abs(flow_w_) - std::max(std::abs(honest_w_), std::abs(ordered_w_));
  energy_.wrong_wh +=
      (flow_w_ * honest_w_ < 0 ? std::abs(flow_w_) : std::max(beyond_w, 0.0)) * hours;
}

void TrialBattery::count_charge() {
  const double one_way = std::sqrt(nature_.round_trip_frac);
  const double cells_w = (flow_w_ > 0 ? flow_w_ * one_way : flow_w_ / one_way) - nature_.standby_w;
  const double moved_frac = cells_w / kSecondsPerHour / nature_.capacity_wh;
  const double before_frac = charge_frac_;
  charge_frac_ = std::clamp(charge_frac_ + moved_frac, 0.0, 1.0);
  count_error_frac_ += (nature_.counted_frac - 1) * (charge_frac_ - before_frac);
  // Between two calibrations the count drifts with the energy, towards its next error.
  const double drift = 0.04 * std::abs(charge_frac_ - before_frac);
  count_error_frac_ += std::clamp(target_error_frac_ - count_error_frac_, -drift, drift);
  // Its voltage shows that it is full, or empty: the difference is corrected gradually.
  const bool is_at_end = charge_frac_ > 0.995 || charge_frac_ < 0.02;
  if (is_at_end) count_error_frac_ -= std::clamp(count_error_frac_, -kCreep, kCreep);
  constexpr double kSettleS = 600;
  const double surface_frac = flow_w_ > 500 ? nature_.settles_frac : 0;
  surface_frac_ += (surface_frac - surface_frac_) / kSettleS;
  resting_s_ = std::abs(flow_w_) < 50 ? resting_s_ + 1 : 0;
  if (nature_.calibration != Calibration::kNone) calibrate();
}

/// At rest the voltage shows the charge: the count moves immediately. At the ends it is 0 or 1.
void TrialBattery::calibrate() {
  const int day = static_cast<int>(now_s_ / kSecondsPerDay);
  if (day == calibration_day_) return;
  std::uniform_real_distribution<> size(nature_.calibration_min_frac, nature_.calibration_max_frac);
  if (nature_.calibration == Calibration::kAtRest) {
    if (resting_s_ < kRestUntilCalibratedS) return;
    const bool was_off = std::abs(count_error_frac_) > nature_.calibration_min_frac / 2;
    const double sign = random_() % 2 == 0 ? 1 : -1;
    count_error_frac_ = target_error_frac_ = was_off ? 0 : sign * size(random_);
  } else {
    const bool at_top = charge_frac_ > 0.99;
    const bool at_bottom = charge_frac_ < 0.11 && count_error_frac_ > 0.03;
    if (!at_top && !at_bottom) return;
    count_error_frac_ = 0;
    target_error_frac_ = (random_() % 3 == 0 ? 1 : -1) * size(random_);
  }
  calibration_day_ = day;
}

void TrialBattery::begin_fault(const TrialFault& fault, const FaultTimes& times,
                               std::int64_t first_tick_utc_s) {
  advance();
  fault_ = &fault;
  times_ = times;
  fault_tick_s_ = first_tick_utc_s;
}

bool TrialBattery::is_faulty() {
  if (fault_ == nullptr || now_s_ < fault_tick_s_) return false;
  const std::int64_t tick = (now_s_ - fault_tick_s_) / kSecondsPerStep;
  if (times_.probability == 0) return tick % times_.every == 0;
  if (tick != drawn_tick_) {
    drawn_tick_ = tick;
    drawn_ = std::uniform_real_distribution<>(0, 1)(random_) < times_.probability;
  }
  return drawn_;
}

void TrialBattery::note_fault_begin() {
  fault_since_s_ = now_s_;
  ordered_at_fault_w_ = ordered_w_;
  charge_at_fault_frac_ = charge_frac_;
  shown_at_fault_ = shown_;
}

std::int32_t TrialBattery::shown_soc_e4() {
  if (nature_.soc_refresh_s > 0 && now_s_ % nature_.soc_refresh_s != 0) return shown_.soc_e4;
  double steps = counted_frac() * 1e4 / nature_.soc_step_e4;
  if (nature_.soc_flickers) steps += std::uniform_real_distribution<>(-0.5, 0.5)(random_);
  const auto soc_e4 = static_cast<std::int32_t>(std::lround(steps)) * nature_.soc_step_e4;
  return std::clamp(soc_e4, 0, 10'000);
}

BatteryMeasurement TrialBattery::honest_display() {
  BatteryMeasurement m;
  m.soc_e4 = shown_soc_e4();
  m.power_w = to_watts(flow_w_ * nature_.meter_gain + nature_.meter_offset_w);
  m.capacity_wh = to_watts(nature_.shown_capacity_wh);
  if (nature_.shows_derating) {
    m.charge_w_max = to_watts(charge_limit_w());
    m.discharge_w_max = to_watts(discharge_limit_w());
  }
  m.temperature_min_deci_c = to_watts(temperature_c() * 10);
  m.temperature_max_deci_c = m.temperature_min_deci_c + 20;
  return m;
}

void TrialBattery::show() {
  shown_ = honest_display();
  if (!was_faulty_ || fault_->show == nullptr) return;
  fault_->show({.is_dispatched = is_dispatched_,
                .ordered_w = ordered_w_,
                .flow_w = flow_w_,
                .honest_w = honest_w_,
                .charged_frac = charge_frac_ - charge_at_fault_frac_,
                .fault_s = now_s_ - fault_since_s_,
                .at_fault = shown_at_fault_},
               shown_);
}

}  // namespace bess::trial
