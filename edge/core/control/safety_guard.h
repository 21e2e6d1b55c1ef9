// Guard between student and battery [SPEC 7]: pure integers, no state but the SoC hysteresis.
// Precedence: stop reasons (clock, link, alarm, temperature, off-grid, supervision, price) > limits
// of SoC, reserve, full cycles, reversals, power and site > ramp > operator's hold > operator's
// rules > price thresholds > full charge > student. Every intervention has a reason. A hold needs
// no price: price stop reasons do not apply.
#pragma once

#include <cstdint>
#include <optional>

#include "edge/core/control/control_types.h"
#include "edge/core/control/full_charge.h"
#include "edge/core/control/site_types.h"
#include "shared/decision_rule.h"
#include "shared/price_thresholds.h"
#include "shared/soc_latches.h"

namespace bess {

struct GuardSettings {
  std::int32_t power_w = 4'000;     ///< rated power of the battery, both directions
  PriceThresholds thresholds = {};  ///< beyond them the student is ignored
  std::int32_t soc_min_e4 = 1'000;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t soc_hysteresis_e4 = 50;  ///< distance from a bound before it opens again
  std::int32_t ramp_w_max = 0;          ///< largest change from one order to the next; 0 = no limit
  std::int32_t price_age_s_max = 240;
  /// Time after it in which an estimated price may be used; 0 = never.
  std::int32_t stand_in_s_max = 0;
  std::int32_t temperature_min_deci_c = 0;
  std::int32_t temperature_max_deci_c = 500;

  /// Gentle: half the rated power.
  [[nodiscard]] constexpr std::int32_t full_charge_power_w() const { return power_w / 2; }
};

struct GuardInputs {
  std::int64_t now_utc_s = 0;
  bool clock_ok = false;
  bool link_ok = false;
  BatteryMeasurement measurement;  ///< valid when link_ok
  /// Stop reason of the supervision.
  std::optional<Reason> supervision{};
  bool cycle_budget_spent = false;
  int barred_direction = 0;           ///< sign of a power that would exceed the reversal cap
  std::int32_t previous_power_w = 0;  ///< order in force until now
  bool has_price = false;
  std::int64_t price_minute_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  bool price_is_frozen = false;  ///< long enough to count as no price
  bool price_stands_in = false;  ///< estimate, because the newest price is too old
  Action student_action = Action::kIdle;
  bool held = false;                ///< an operator's hold is in force
  std::int32_t held_power_w = 0;    ///< of that hold
  std::int32_t reserve_soc_e4 = 0;  ///< kept for a power failure at this hour; 0 = none
  FullChargeRequest full_charge = FullChargeRequest::kNone;
  RuleLimits rules{};  ///< operator's rules at this state
  SiteRange site{};
};

/// Seconds since the row was computed, which is the END of its minute.
constexpr std::int64_t price_age_s(std::int64_t now_utc_s, std::int64_t price_minute_utc_s) {
  return now_utc_s - (price_minute_utc_s + 60);
}

class SafetyGuard {
 public:
  explicit SafetyGuard(const GuardSettings& settings)
      : settings_(settings),
        soc_{settings.soc_min_e4, settings.soc_max_e4, settings.soc_hysteresis_e4} {}

  /// Power to order, and the reason if it is not the student's action.
  GuardDecision decide(const GuardInputs& in);

  /// The newest price is too old to trade on, but recent enough for an estimate.
  [[nodiscard]] bool may_stand_in(const GuardInputs& in) const;

  /// Applies the present limits to the order in force (`previous_power_w`) between two decisions.
  /// Never increases charging or discharging, except for the site's peak relief.
  [[nodiscard]] std::int32_t rechecked_power_w(const GuardInputs& in) const;

 private:
  [[nodiscard]] std::optional<Reason> stop_reason(const GuardInputs& in) const;
  [[nodiscard]] std::optional<Reason> price_stop_reason(const GuardInputs& in) const;
  [[nodiscard]] std::optional<Reason> age_stop_reason(const GuardInputs& in) const;
  [[nodiscard]] GuardDecision find_requested_action(const GuardInputs& in) const;
  [[nodiscard]] GuardDecision find_price_action(const GuardInputs& in) const;
  [[nodiscard]] GuardDecision find_student_action(const GuardInputs& in) const;
  void update_soc(std::int32_t soc_e4, std::int32_t reserve_soc_e4);
  void apply_ramp(std::int32_t previous_power_w, GuardDecision& decision) const;
  void apply_limits(const GuardInputs& in, GuardDecision& decision) const;
  void apply_relief(const SiteRange& site, GuardDecision& decision) const;
  static void apply_site(const SiteRange& site, GuardDecision& decision);

  GuardSettings settings_;
  SocLatches soc_;
  bool reserved_ = false;  ///< discharging is closed until SoC is above the reserve + hysteresis
};

}  // namespace bess
