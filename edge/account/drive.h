// The battery of the specification, driven through logged prices: what others than the controller
// would have earned. Estimates: 90 % there and back [SPEC 3], each cycle at the price that it was
// decided on.
#pragma once

#include <cstdint>
#include <span>

#include "edge/control/control_types.h"
#include "shared/battery_model.h"
#include "shared/price_thresholds.h"

namespace bess {

/// A cycle that had a price.
struct PricedCycle {
  std::int64_t utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  std::int16_t context_class = 1;  ///< what the student is given, or would have been
};

/// Of a record with a price.
PricedCycle priced_cycle(const CycleRecord& record);
double eur_per_mwh(const PricedCycle& cycle);

/// At full power.
BatteryStep full_step(const BatteryParameters& battery, double soc_frac, Action action);
double earned_eur(const BatteryStep& step, double price_eur_per_mwh);

/// What student and thresholds decide where nobody is in their way.
Action decide_undisturbed(const PricedCycle& cycle, double soc_frac,
                          const PriceThresholds& thresholds);

struct Driven {
  double earned_eur = 0;
  double soc_frac = 0;  ///< at the end
};

/// `decide(index of the cycle, SoC)`, over all cycles.
template <typename Decide>
Driven drive_through(std::span<const PricedCycle> cycles, double soc_frac,
                     const BatteryParameters& battery, const Decide& decide) {
  Driven driven{.soc_frac = soc_frac};
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const BatteryStep next = full_step(battery, driven.soc_frac, decide(i, driven.soc_frac));
    driven.earned_eur += earned_eur(next, eur_per_mwh(cycles[i]));
    driven.soc_frac = next.soc_frac;
  }
  return driven;
}

}  // namespace bess
