#include "edge/core/supervision/response_monitor.h"

#include <algorithm>
#include <cstdlib>

#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// Above this SoC, and up to this much above the orders' floor, a battery may reduce power.
constexpr std::int32_t kSlowFromE4 = 8'000;
constexpr std::int32_t kSlowAboveFloorE4 = 2'000;
/// Up to here a battery protects itself from deep discharge; from there on it balances its cells.
constexpr std::int32_t kSavesItselfE4 = 1'200;
constexpr std::int32_t kBalancesFromE4 = 9'500;
constexpr std::int32_t kBalancingPercentMax = 15;  ///< of the rating
/// A battery with a slower ramp from rest to its rating does not follow, whatever it moves.
constexpr std::int32_t kFullRampS = 180;
/// A device may start later than its map says: after a cut, or in a cycle shortened by a clock
/// step, it still follows the previous order.
constexpr std::int32_t kLateS = 10;

}  // namespace

void ResponseMonitor::observe(const Response& now) {
  judge_power(now);
  soc_.observe(now);
  trip_if(soc_.contradicts(), Reason::kSocMismatch);  // power is stronger evidence
  count_locked(now.measurement);
  has_before_ = true;
  before_s_ = now.steady_s;
  before_power_w_ = now.measurement.power_w;
  before_ordered_w_ = now.ordered_power_w;
  before_may_be_less_ = may_be_less(now);
  before_is_on_its_way_ = is_on_its_way_;
}

ResponseFindings ResponseMonitor::findings() const {
  return {.energy_share_percent = soc_.balance().share_percent,
          .rest_loss_w = soc_.balance().rest_loss_w,
          .ramp_w_per_s = slow_.is_found() ? ramp_w_per_s_ : 0,
          .locked_readings = locked_readings_,
          .wrong_energy_e6 = wrong_energy_.share_e6()};
}

/// No order can then go unanswered.
void ResponseMonitor::count_locked(const BatteryMeasurement& m) {
  const bool is_locked = std::max(m.charge_w_max, m.discharge_w_max) <= settings_.noise_w();
  const int readings = is_locked ? locked_readings_ + 1 : 0;
  locked_readings_ = static_cast<std::int16_t>(std::min(readings, INT16_MAX));
}

void ResponseMonitor::trip_if(bool is_found, Reason reason) {
  if (is_found && !trip_) trip_ = reason;
}

void ResponseMonitor::note_energy(const Response& now, std::int64_t wrong_w) {
  const std::int32_t reported_wh = now.measurement.capacity_wh;
  wrong_energy_.add(now, wrong_w, reported_wh > 0 ? reported_wh : settings_.capacity_wh);
}

void ResponseMonitor::note_wrong(const Response& now, std::int64_t wrong_w, Reason reason) {
  note_energy(now, wrong_w);
  if (wrong_w > 0) trip_if(wrong_energy_.is_found(), reason);
}

/// Judged as if it ended a step. Too early is no evidence: orders may change before.
void ResponseMonitor::note_between(const Response& now) {
  if (now.order_age_s < settings_.band.settle_s + kLateS) return;
  ResponseMonitor as_if = *this;
  as_if.judge_power(now);
  wrong_energy_ = as_if.wrong_energy_;
  if (wrong_energy_.is_found()) trip_ = as_if.trip_;
}

void ResponseMonitor::judge_power(const Response& now) {
  answers_ = needs_no_care_ = is_on_its_way_ = false;
  if (!now.is_driven || now.order_age_s < settings_.band.settle_s || has_not_begun(now)) return;
  if (power_magnitude_w(now.ordered_power_w) <= settings_.noise_w()) return judge_idle(now);
  judge_driven(now);
}

void ResponseMonitor::judge_idle(const Response& now) {
  const std::int32_t measured_w = now.measurement.power_w;
  unanswered_orders_ = 0;
  const bool charges = measured_w > 0 && settings_.band.charges_by_itself;
  if (power_magnitude_w(measured_w) <= 2 * settings_.noise_w() || charges) {
    excessive_idle_.good();
    care_.good();
    needs_no_care_ = true;
    note_energy(now, 0);
  } else if (is_care(now.measurement)) {
    care_.bad();
  } else if (!is_ramp(now)) {
    excessive_idle_.bad();
    trip_if(excessive_idle_.is_found(), Reason::kUncontrolledPower);
    note_wrong(now, power_magnitude_w(measured_w), Reason::kUncontrolledPower);
  }
}

void ResponseMonitor::judge_driven(const Response& now) {
  const std::int32_t noise_w = settings_.noise_w();
  const std::int32_t ordered_w = power_magnitude_w(now.ordered_power_w);
  const bool is_charging = now.ordered_power_w > 0;
  const std::int32_t measured_w =  // positive: as ordered
      is_charging ? now.measurement.power_w : opposite_power_w(now.measurement.power_w);
  // PV may exceed a discharge order: no evidence.
  if (!is_charging && measured_w < 0 && settings_.band.charges_by_itself) return;
  if (measured_w < -noise_w) {
    if (is_care(now.measurement)) return care_.bad();
    // A device may ramp its set point: it then starts from the previous order, whatever flowed.
    if (!is_ramp(now) && !note_ramp(now, before_ordered_w_)) {
      opposed_.bad(is_charging);
      trip_if(opposed_.is_found(), Reason::kWrongDirection);
      note_wrong(now, -std::int64_t{measured_w}, Reason::kWrongDirection);
    }
    return;
  }
  const bool is_pv = is_charging && settings_.band.charges_by_itself;
  if (measured_w - ordered_w > settings_.tolerance_w(ordered_w) && !is_pv) {
    if (is_ramp(now)) return;
    excessive_driven_.bad(is_charging);
    trip_if(excessive_driven_.is_found(), Reason::kUncontrolledPower);
    return note_wrong(now, std::int64_t{measured_w} - ordered_w, Reason::kUncontrolledPower);
  }
  excessive_driven_.good(is_charging);
  note_energy(now, 0);
  judge_answer(now, measured_w);
}

/// `measured_w`: in the direction of the order.
void ResponseMonitor::judge_answer(const Response& now, std::int32_t measured_w) {
  const std::int32_t noise_w = settings_.noise_w();
  const bool is_charging = now.ordered_power_w > 0;
  answers_ = measured_w > std::max(noise_w, power_magnitude_w(now.ordered_power_w) / 10);
  unanswered_orders_ = answers_ ? 0 : unanswered_orders_ + 1;
  if (answers_) {
    opposed_.good(is_charging);
    unexplained_.good(is_charging);
    care_.good();
    needs_no_care_ = true;
  }
  const std::int32_t wanted_w = reachable_power_w(now);
  const bool is_weak = measured_w < wanted_w - settings_.tolerance_w(wanted_w) &&
                       wanted_w > 2 * noise_w && !may_be_less(now);
  if (!is_weak) {
    weak_answers_ = 0;
    if (answers_) slow_.good();
    return;
  }
  if (!answers_) unexplained_.bad(is_charging);
  // Constant 0 W is not a ramp through 0 W.
  if (measured_w <= noise_w || !note_ramp(now, before_power_w_)) ++weak_answers_;
}

/// True if the power is ramping to a new order, too slow for its map but faster than a fault that
/// merely differs between readings.
bool ResponseMonitor::note_ramp(const Response& now, std::int32_t from_w) {
  if (!knows_before(now)) return false;
  // From its order on; for an order read again while ramping, since the previous reading.
  const bool is_young = is_new_order(now) || now.order_age_s <= kFullRampS;
  const std::int64_t seconds = std::min<std::int64_t>(now.order_age_s, now.steady_s - before_s_);
  if (!is_young || seconds <= 0) return false;
  const std::int64_t left_w = std::int64_t{now.ordered_power_w} - from_w;
  const std::int64_t moved_w = std::int64_t{now.measurement.power_w} - from_w;
  const std::int64_t towards_w = left_w < 0 ? -moved_w : moved_w;
  const bool is_short = is_new_order(now) && now.order_age_s < kSecondsPerStep / 2;
  const std::int64_t moving_s = is_short ? std::max<std::int64_t>(seconds - kLateS, 0) : seconds;
  const std::int64_t least_w = settings_.power_w * moving_s / kFullRampS;
  if (towards_w < least_w || towards_w > std::max(left_w, -left_w)) return false;
  is_on_its_way_ = true;
  if (slow_.level == 0) ramp_w_per_s_ = 0;
  // A lag moves a small step less in the same time: the largest step shows the limit.
  ramp_w_per_s_ = std::max(ramp_w_per_s_, static_cast<std::int32_t>(towards_w / seconds));
  slow_.bad();
  return true;
}

/// After a long gap the intermediate power is unknown.
bool ResponseMonitor::knows_before(const Response& now) const {
  const std::int64_t seconds = now.steady_s - before_s_;
  return has_before_ && seconds > 0 && seconds <= kReadingGapMaxS;
}

bool ResponseMonitor::is_new_order(const Response& now) const {
  return knows_before(now) && now.order_age_s <= now.steady_s - before_s_;
}

/// Just past its settling time, and power still follows the previous order.
bool ResponseMonitor::has_not_begun(const Response& now) const {
  const std::int32_t latest_s = std::min(settings_.band.settle_s + kLateS, kSecondsPerStep / 2);
  if (!is_new_order(now) || now.order_age_s >= latest_s) return false;
  const std::int64_t apart_w = std::int64_t{now.measurement.power_w} - before_power_w_;
  return std::abs(apart_w) <= settings_.tolerance_w(before_power_w_);
}

bool ResponseMonitor::is_ramp(const Response& now) {
  if (!knows_before(now)) return may_be_ramp(now);
  return note_ramp(now, before_power_w_) || is_ramp_of_order_before(now);
}

/// Near full and near empty less power flows than the ramped set point, which starts at the
/// previous order and must first fall below that power. An earlier ramp has continued with it.
bool ResponseMonitor::is_ramp_of_order_before(const Response& now) {
  const std::int32_t moved_w =
      power_magnitude_w(before_power_w_) - power_magnitude_w(now.measurement.power_w);
  const bool is_less = before_may_be_less_ && moved_w > settings_.noise_w();
  return (is_less || before_is_on_its_way_) && note_ramp(now, before_ordered_w_);
}

/// The first reading of a new order, previous one unknown: it starts from the rating at most.
bool ResponseMonitor::may_be_ramp(const Response& now) const {
  if (now.order_age_s > kSecondsPerStep) return false;
  const std::int64_t apart_w = std::int64_t{now.measurement.power_w} - now.ordered_power_w;
  const std::int64_t rated_w = apart_w < 0 ? -std::int64_t{settings_.power_w} : settings_.power_w;
  const std::int64_t least_w = std::int64_t{settings_.power_w} * now.order_age_s / kFullRampS;
  return std::abs(apart_w) <= std::abs(rated_w - now.ordered_power_w) - least_w;
}

bool ResponseMonitor::is_care(const BatteryMeasurement& m) const {
  if (m.power_w <= 0) return false;
  const std::int64_t balancing_w = std::int64_t{settings_.power_w} * kBalancingPercentMax / 100;
  return m.soc_e4 <= kSavesItselfE4 || (m.soc_e4 >= kBalancesFromE4 && m.power_w <= balancing_w);
}

/// Ordered power within the device's own limits.
std::int32_t ResponseMonitor::reachable_power_w(const Response& now) const {
  const BatteryMeasurement& m = now.measurement;
  const std::int32_t limit_w = now.ordered_power_w > 0 ? m.charge_w_max : m.discharge_w_max;
  return std::min(power_magnitude_w(now.ordered_power_w), std::max(limit_w, 0));
}

bool ResponseMonitor::may_be_less(const Response& now) const {
  const BatteryMeasurement& m = now.measurement;
  const bool is_charging = now.ordered_power_w > 0;
  if (is_charging && m.temperature_min_deci_c < kColdDeciC) return true;
  if (!is_charging && settings_.band.charges_by_itself) return true;  // PV takes its share
  return is_charging ? m.soc_e4 >= kSlowFromE4 : m.soc_e4 <= now.soc_floor_e4 + kSlowAboveFloorE4;
}

}  // namespace bess
