// What one cycle moved and earned, by its record alone: an estimate, at the price decided on.
#pragma once

#include "edge/control/control_types.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Grid side, positive is charged; nothing where nothing was measured.
constexpr double cycle_energy_wh(const CycleRecord& record) {
  return record.has_measurement ? record.measurement.power_w * kHoursPerStep : 0.0;
}

/// Nothing where there is no price. From 0: a cycle at rest has earned nothing, and not minus
/// nothing.
constexpr double cycle_earned_eur(const CycleRecord& record) {
  if (!record.price.has_row) return 0.0;
  return 0.0 - cycle_energy_wh(record) / kWattsPerMegawatt * record.price.price_centi_eur_per_mwh /
                   kCentiPerEur;
}

}  // namespace bess
