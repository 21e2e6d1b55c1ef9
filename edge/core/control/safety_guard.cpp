#include "edge/core/control/safety_guard.h"

#include "edge/core/control/quarter_hour_energy.h"
#include "shared/fixed_point.h"

namespace bess {
namespace {

Reason students_reason(const GuardInputs& in) {
  return in.price_stands_in ? Reason::kStandIn : Reason::kStudent;
}

}  // namespace

GuardDecision SafetyGuard::decide(const GuardInputs& in) {
  if (in.link_ok) update_soc(in.measurement.soc_e4, in.reserve_soc_e4);
  if (const auto reason = stop_reason(in)) return {.power_w = 0, .reason = *reason};
  GuardDecision decision = find_requested_action(in);
  apply_ramp(in.previous_power_w, decision);
  apply_relief(in.site, decision);
  apply_limits(in, decision);
  return decision;
}

std::int32_t SafetyGuard::rechecked_power_w(const GuardInputs& in) const {
  GuardDecision decision{.power_w = in.previous_power_w};
  apply_relief(in.site, decision);
  apply_limits(in, decision);
  return decision.power_w;
}

std::optional<Reason> SafetyGuard::stop_reason(const GuardInputs& in) const {
  const BatteryMeasurement& m = in.measurement;
  if (!in.clock_ok) return Reason::kClock;
  if (!in.link_ok) return Reason::kLink;
  if (m.alarm) return Reason::kAlarm;
  if (m.temperature_min_deci_c < settings_.temperature_min_deci_c ||
      m.temperature_max_deci_c > settings_.temperature_max_deci_c) {
    return Reason::kTemperature;
  }
  if (m.off_grid) return Reason::kOffGrid;
  if (m.grid_unknown) return Reason::kGridUnknown;
  if (m.lost_point != 0) return Reason::kProtectionLost;
  if (in.supervision) return in.supervision;
  return in.held ? std::nullopt : price_stop_reason(in);
}

std::optional<Reason> SafetyGuard::price_stop_reason(const GuardInputs& in) const {
  if (!in.has_price) return Reason::kNoPrice;
  const std::optional<Reason> age = age_stop_reason(in);
  if (age && !(in.price_stands_in && may_stand_in(in))) return age;
  if (in.price_is_frozen) return Reason::kFrozenPrice;
  return std::nullopt;
}

std::optional<Reason> SafetyGuard::age_stop_reason(const GuardInputs& in) const {
  const std::int64_t age_s = price_age_s(in.now_utc_s, in.price_minute_utc_s);
  if (age_s > settings_.price_age_s_max || age_s < -60) {  // a future row is no price either
    return Reason::kPriceAge;
  }
  const bool is_of_now =
      quarter_hour_of(in.now_utc_s) - quarter_hour_of(in.price_minute_utc_s) <= 1;
  if (is_of_now) return std::nullopt;
  return Reason::kPriceQuarterHour;
}

bool SafetyGuard::may_stand_in(const GuardInputs& in) const {
  const std::int64_t age_s = price_age_s(in.now_utc_s, in.price_minute_utc_s);
  return in.has_price && settings_.stand_in_s_max > 0 && age_s >= 0 &&
         age_s <= settings_.price_age_s_max + settings_.stand_in_s_max &&
         age_stop_reason(in).has_value();
}

GuardDecision SafetyGuard::find_requested_action(const GuardInputs& in) const {
  if (in.held) {
    return {.power_w = clamp_to(in.held_power_w, -settings_.power_w, settings_.power_w),
            .reason = Reason::kHeld};
  }
  GuardDecision decision = find_price_action(in);
  // Moves to the nearest action and power that the rules permit.
  const std::int32_t ruled_w = ruled_power_w(in.rules, decision.power_w, settings_.power_w);
  if (ruled_w != decision.power_w) decision = {.power_w = ruled_w, .reason = Reason::kRule};
  return decision;
}

GuardDecision SafetyGuard::find_price_action(const GuardInputs& in) const {
  const Action of_price = settings_.thresholds.action_beyond(in.price_centi_eur_per_mwh);
  if (of_price == Action::kIdle) return find_student_action(in);
  const Reason of_threshold = of_price == Action::kCharge ? Reason::kPriceLow : Reason::kPriceHigh;
  // Agreement with the student is no intervention.
  return {.power_w = power_sign(of_price) * settings_.power_w,
          .reason = of_price == in.student_action ? students_reason(in) : of_threshold};
}

GuardDecision SafetyGuard::find_student_action(const GuardInputs& in) const {
  if (in.full_charge == FullChargeRequest::kCharge) {
    return {.power_w = settings_.full_charge_power_w(), .reason = Reason::kFullCharge};
  }
  if (in.full_charge == FullChargeRequest::kNoDischarge &&
      in.student_action == Action::kDischarge) {
    return {.power_w = 0, .reason = Reason::kFullCharge};
  }
  return {.power_w = power_sign(in.student_action) * settings_.power_w,
          .reason = students_reason(in)};
}

void SafetyGuard::update_soc(std::int32_t soc_e4, std::int32_t reserve_soc_e4) {
  soc_.update(soc_e4);
  if (soc_e4 <= reserve_soc_e4) reserved_ = true;
  if (soc_e4 > reserve_soc_e4 + settings_.soc_hysteresis_e4 || reserve_soc_e4 == 0) {
    reserved_ = false;
  }
}

void SafetyGuard::apply_ramp(std::int32_t previous_power_w, GuardDecision& decision) const {
  if (settings_.ramp_w_max == 0) return;
  // An order found in force may be another controller's, with a larger power.
  const std::int32_t from_w =
      clamp_to<std::int32_t>(previous_power_w, -settings_.power_w, settings_.power_w);
  const std::int32_t ramped = clamp_to<std::int32_t>(
      decision.power_w, from_w - settings_.ramp_w_max, from_w + settings_.ramp_w_max);
  if (ramped != decision.power_w) decision = {.power_w = ramped, .reason = Reason::kRamp};
}

void SafetyGuard::apply_limits(const GuardInputs& in, GuardDecision& decision) const {
  if (decision.power_w > 0 && soc_.is_full) decision = {.power_w = 0, .reason = Reason::kSocFull};
  // Relief returns energy taken in this quarter-hour: it may go down to the bound.
  const bool is_relief = decision.reason == Reason::kQuarterHourPeak;
  const std::int32_t soc_e4 = in.measurement.soc_e4;
  const bool is_empty = is_relief ? soc_e4 <= settings_.soc_min_e4 : soc_.is_empty;
  const bool is_reserved = is_relief ? soc_e4 <= in.reserve_soc_e4 : reserved_;
  if (decision.power_w < 0 && is_empty) decision = {.power_w = 0, .reason = Reason::kSocEmpty};
  if (decision.power_w < 0 && is_reserved) decision = {.power_w = 0, .reason = Reason::kReserve};
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
  apply_site(in.site, decision);
}

/// Applied before the limits: an empty or limited battery gives no relief.
void SafetyGuard::apply_relief(const SiteRange& site, GuardDecision& decision) const {
  const std::int32_t relief_w = std::min(site.relief_w, settings_.power_w);
  if (relief_w > 0 && decision.power_w > -relief_w) {
    decision = {.power_w = -relief_w, .reason = Reason::kQuarterHourPeak};
  }
}

/// Applied last: it only cuts; the tightest cut sets the reason.
void SafetyGuard::apply_site(const SiteRange& site, GuardDecision& decision) {
  if (decision.power_w > site.charge_w_max) {
    decision = {.power_w = site.charge_w_max, .reason = site.charge_reason};
  }
  if (decision.power_w < -site.discharge_w_max) {
    decision = {.power_w = -site.discharge_w_max, .reason = site.discharge_reason};
  }
}

}  // namespace bess
