// One step of the battery, a pure function [Paper, Eq. 2, 4, 5; SPEC 3].
//   SoC' = SoC + (max(p,0) * eta_charge + min(p,0) / eta_discharge) * dt / C
// p is the average power REALLY exchanged over the step: at a bound only what still fits flows, and
// only that is paid.
#pragma once

#include "shared/trading_costs.h"

namespace bess {

struct BatteryParameters {
  double power_w_max = 4e6;                       ///< P, grid side, both directions
  double capacity_wh = 8e6;                       ///< C
  double charge_efficiency = 0.9486832980505138;  ///< sqrt(0.9): 90 % round trip
  double discharge_efficiency = 0.9486832980505138;
  double soc_min_frac = 0.10;
  double soc_max_frac = 1.00;
  // What using it costs, and how much it may be used: battery_step knows nothing of these three,
  // accounting and planning do (exchange_cost.h).
  double wear_eur_per_mwh = 0;    ///< of throughput: charged and discharged energy, grid side
  TradingCosts costs{};           ///< beside the price
  double cycles_per_day_max = 0;  ///< equivalent full cycles a local day; 0 = no limit
};

struct BatteryStep {
  double power_w;   ///< average over the step, grid side, charge positive
  double soc_frac;  ///< at the end of the step
};

/// Exchanges up to `wanted_power_w` for `hours`. Never leaves [soc_min, soc_max]; a battery that
/// starts outside moves towards the window or rests, never further away.
constexpr BatteryStep battery_step(const BatteryParameters& battery, double soc_frac,
                                   double wanted_power_w, double hours) {
  const double limit_w = battery.power_w_max;
  double power_w = wanted_power_w > limit_w    ? limit_w
                   : wanted_power_w < -limit_w ? -limit_w
                                               : wanted_power_w;
  if (power_w > 0) {
    const double room_wh = (battery.soc_max_frac - soc_frac) * battery.capacity_wh;
    const double fits_w = room_wh > 0 ? room_wh / (battery.charge_efficiency * hours) : 0.0;
    if (power_w >= fits_w) return {fits_w, fits_w > 0 ? battery.soc_max_frac : soc_frac};
    return {power_w, soc_frac + power_w * battery.charge_efficiency * hours / battery.capacity_wh};
  }
  if (power_w < 0) {
    const double stored_wh = (soc_frac - battery.soc_min_frac) * battery.capacity_wh;
    const double fits_w = stored_wh > 0 ? -stored_wh * battery.discharge_efficiency / hours : 0.0;
    if (power_w <= fits_w) return {fits_w, fits_w < 0 ? battery.soc_min_frac : soc_frac};
    return {power_w,
            soc_frac + power_w / battery.discharge_efficiency * hours / battery.capacity_wh};
  }
  return {0.0, soc_frac};
}

}  // namespace bess
