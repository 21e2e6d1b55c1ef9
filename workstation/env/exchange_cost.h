// What one exchange costs: the single place where energy becomes money, for accounting and planning alike.
#pragma once

#include <cmath>

#include "shared/battery_model.h"

namespace bess {

/// What exchanging `energy_mwh` (grid side, charge positive) costs at this price, wear included.
inline double exchange_cost_eur(const BatteryParameters& battery, double energy_mwh,
                                double price_eur_per_mwh) {
  return energy_mwh * price_eur_per_mwh + std::fabs(energy_mwh) * battery.wear_eur_per_mwh;
}

}  // namespace bess
