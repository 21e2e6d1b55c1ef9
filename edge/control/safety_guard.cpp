#include "edge/control/safety_guard.h"

#include "shared/fixed_point.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr std::int64_t kQuarterHourS = kMinutesPerQuarterHour * 60;

// Quarter-hours of local time are quarter-hours of UTC: every offset in use is a multiple of 15
// minutes.
constexpr std::int64_t quarter_hour_of(std::int64_t utc_s) { return utc_s / kQuarterHourS; }

}  // namespace

GuardDecision SafetyGuard::decide(const GuardInputs& in) {
  if (in.link_ok) update_soc_latches(in.measurement.soc_e4);
  GuardDecision decision;
  if (find_stop_reason(in, decision.reason)) {
    decision.power_w = 0;
    return decision;
  }
  decision = apply_thresholds(in);
  apply_ramp(in.previous_power_w, decision);
  apply_limits(in, decision);
  return decision;
}

bool SafetyGuard::find_stop_reason(const GuardInputs& in, Reason& reason) const {
  const BatteryMeasurement& m = in.measurement;
  if (!in.clock_ok) {
    reason = Reason::kClock;
  } else if (!in.link_ok) {
    reason = Reason::kLink;
  } else if (m.alarm) {
    reason = Reason::kAlarm;
  } else if (m.temperature_min_deci_c < settings_.temperature_min_deci_c ||
             m.temperature_max_deci_c > settings_.temperature_max_deci_c) {
    reason = Reason::kTemperature;
  } else if (m.off_grid) {
    reason = Reason::kOffGrid;
  } else if (is_stop_reason(in.supervision)) {
    reason = in.supervision;
  } else {
    return find_price_stop_reason(in, reason);
  }
  return true;
}

bool SafetyGuard::find_price_stop_reason(const GuardInputs& in, Reason& reason) const {
  if (!in.has_price) {
    reason = Reason::kNoPrice;
    return true;
  }
  const std::int64_t age_s = price_age_s(in.now_utc_s, in.price_minute_utc_s);
  if (age_s > settings_.price_age_s_max || age_s < -60) {  // a row of the future is no price either
    reason = Reason::kPriceAge;
    return true;
  }
  if (quarter_hour_of(in.now_utc_s) - quarter_hour_of(in.price_minute_utc_s) > 1) {
    reason = Reason::kPriceQuarterHour;
    return true;
  }
  return false;
}

GuardDecision SafetyGuard::apply_thresholds(const GuardInputs& in) const {
  const PriceThresholds& thresholds = settings_.thresholds;
  Action action = in.student_action;
  Reason reason = Reason::kStudent;
  if (in.price_centi_eur_per_mwh <= thresholds.low_eur_per_mwh * kCentiPerEur) {
    action = Action::kCharge;
    reason = Reason::kPriceLow;
  } else if (in.price_centi_eur_per_mwh >= thresholds.high_eur_per_mwh * kCentiPerEur) {
    action = Action::kDischarge;
    reason = Reason::kPriceHigh;
  }
  if (action == in.student_action) reason = Reason::kStudent;  // it agrees: no intervention
  return {.power_w = power_sign(action) * settings_.power_w, .reason = reason};
}

void SafetyGuard::update_soc_latches(std::int32_t soc_e4) {
  if (soc_e4 >= settings_.soc_max_e4) full_ = true;
  if (soc_e4 < settings_.soc_max_e4 - settings_.soc_hysteresis_e4) full_ = false;
  if (soc_e4 <= settings_.soc_min_e4) empty_ = true;
  if (soc_e4 > settings_.soc_min_e4 + settings_.soc_hysteresis_e4) empty_ = false;
}

void SafetyGuard::apply_ramp(std::int32_t previous_power_w, GuardDecision& decision) const {
  if (settings_.ramp_w_max == 0) return;
  // An order that was found in force may be another controller's, of a larger power than ours.
  const std::int32_t from_w =
      clamp_to<std::int32_t>(previous_power_w, -settings_.power_w, settings_.power_w);
  const std::int32_t ramped = clamp_to<std::int32_t>(
      decision.power_w, from_w - settings_.ramp_w_max, from_w + settings_.ramp_w_max);
  if (ramped != decision.power_w) decision = {.power_w = ramped, .reason = Reason::kRamp};
}

void SafetyGuard::apply_limits(const GuardInputs& in, GuardDecision& decision) const {
  if (decision.power_w > 0 && full_) decision = {.power_w = 0, .reason = Reason::kSocFull};
  if (decision.power_w < 0 && empty_) decision = {.power_w = 0, .reason = Reason::kSocEmpty};
  if (decision.power_w != 0 && in.cycle_budget_spent) {
    decision = {.power_w = 0, .reason = Reason::kCycleBudget};
  }
  if ((decision.power_w > 0 && in.barred_direction > 0) ||
      (decision.power_w < 0 && in.barred_direction < 0)) {
    decision = {.power_w = 0, .reason = Reason::kReversalCap};
  }
  const std::int32_t limited = clamp_to<std::int32_t>(
      decision.power_w, -clamp_to<std::int32_t>(in.measurement.discharge_w_max, 0, INT32_MAX),
      clamp_to<std::int32_t>(in.measurement.charge_w_max, 0, INT32_MAX));
  if (limited != decision.power_w) decision = {.power_w = limited, .reason = Reason::kPowerLimit};
}

}  // namespace bess
