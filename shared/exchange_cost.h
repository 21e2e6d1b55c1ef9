// Exchange cost: the only place where energy becomes money, for accounting, planning, learning and
// settlement.
#pragma once

#include <cmath>

#include "shared/battery_model.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Cost of exchanging `energy_mwh` (grid side, charge positive) at this price, with trading costs
/// and wear. Negative: revenue.
inline double exchange_cost_eur(const BatteryParameters& battery, double energy_mwh,
                                double price_eur_per_mwh) {
  const double paid_eur_per_mwh = energy_mwh > 0
                                      ? battery.costs.import_eur_per_mwh(price_eur_per_mwh)
                                      : battery.costs.export_eur_per_mwh(price_eur_per_mwh);
  return energy_mwh * paid_eur_per_mwh + std::fabs(energy_mwh) * battery.wear_eur_per_mwh;
}

/// Profit of a step of `hours`, including own consumption.
inline double step_profit_eur(const BatteryParameters& battery, double energy_mwh, double hours,
                              double price_eur_per_mwh) {
  const double standby_mwh = battery.standby_w / kWattsPerMegawatt * hours;
  return -exchange_cost_eur(battery, energy_mwh, price_eur_per_mwh) -
         standby_mwh * battery.costs.import_eur_per_mwh(price_eur_per_mwh);
}

}  // namespace bess
