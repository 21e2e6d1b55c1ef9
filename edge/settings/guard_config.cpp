#include "edge/settings/guard_config.h"

#include <algorithm>

#include "edge/settings/operator_config.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// In whole EUR/MWh, as the proof counts them: 1500 as well as 1500.0.
void read_threshold(TomlTable& table, std::string_view key, std::int32_t& eur_per_mwh) {
  std::int32_t centi_eur_per_mwh = eur_per_mwh * kCentiPerEur;
  table.scaled(key, centi_eur_per_mwh, kCentiPerEur, -kThresholdMaxEurPerMwh,
               kThresholdMaxEurPerMwh);
  if (centi_eur_per_mwh % kCentiPerEur != 0) {
    table.fail(key, "must be whole EUR/MWh, as the student is proved for");
  }
  eur_per_mwh = centi_eur_per_mwh / kCentiPerEur;
}

/// Twelve for a battery that is full in an hour, fewer for a slower one: what honest prices have
/// needed.
std::int32_t default_cycles_per_day_e4(std::int32_t power_w, std::int32_t capacity_wh) {
  const std::int64_t cycles_e4 = std::int64_t{120'000} * power_w / capacity_wh;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(cycles_e4, 10'000, 1'000'000));
}

}  // namespace

void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control) {
  GuardSettings& guard = control.guard;
  read_threshold(table, "low_price_eur_per_mwh", guard.thresholds.low_eur_per_mwh);
  read_threshold(table, "high_price_eur_per_mwh", guard.thresholds.high_eur_per_mwh);
  table.scaled("soc_min", guard.soc_min_e4, 10'000, 0, 1);
  table.scaled("soc_max", guard.soc_max_e4, 10'000, 0, 1);
  table.integer("price_age_s_max", guard.price_age_s_max, 60, 1'800);
  table.integer("stand_in_s_max", guard.stand_in_s_max, 0, 3'600);
  table.integer("frozen_price_s_max", control.frozen_price.stop_s, 0, 86'400);
  table.scaled("temperature_min_c", guard.temperature_min_deci_c, 10, -50, 100);
  table.scaled("temperature_max_c", guard.temperature_max_deci_c, 10, -50, 100);
  table.integer("ramp_w_max", guard.ramp_w_max, 0, 100'000'000);
  control.cycles_per_day_max_e4 = default_cycles_per_day_e4(guard.power_w, battery.capacity_wh);
  table.scaled("cycles_per_day_max", control.cycles_per_day_max_e4, 10'000, 0, 100);
  table.integer("reversals_per_hour_max", control.reversals_per_hour_max, 0, kStepsPerHour);
  table.finish();
  if (!guard.thresholds.are_ordered()) {
    table.fail("low_price_eur_per_mwh", "must be below high_price_eur_per_mwh");
  }
  if (guard.soc_min_e4 + 2 * guard.soc_hysteresis_e4 >= guard.soc_max_e4) {
    table.fail("soc_min", "must be below soc_max by more than 0.01");
  }
  if (guard.temperature_min_deci_c >= guard.temperature_max_deci_c) {
    table.fail("temperature_min_c", "must be below temperature_max_c");
  }
}

}  // namespace bess
