// The battery of the specification, driven through the log's cycles: what others than the
// controller would have earned, 90 % there and back [SPEC 3]. Each decides on the price that the
// controller had then, with the delay that it came with, and is paid as the controller is
// (quarter_prices.h). Its order begins at the tick, as in the workstation; the controller's some
// seconds later.
#pragma once

#include <cstdint>
#include <span>

#include "edge/account/quarter_prices.h"
#include "edge/control/control_types.h"
#include "shared/battery_model.h"
#include "shared/price_thresholds.h"

namespace bess {

/// A cycle that had a price.
struct PricedCycle {
  std::int64_t utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;  ///< that is decided on
  float paid_eur_per_mwh = 0;
  std::int16_t context_class = 1;  ///< what this program's student is given
};

/// Of a record with a price; the log behind it is noted in `prices`.
PricedCycle priced_cycle(const CycleRecord& record, const QuarterPrices& prices);

/// At full power.
BatteryStep full_step(const BatteryParameters& battery, double soc_frac, Action action);
/// Less what the battery costs (exchange_cost.h).
double earned_eur(const BatteryParameters& battery, const BatteryStep& step,
                  double price_eur_per_mwh);
/// What is stored more than before as if it was sold at once, and what is stored less as if it was
/// bought, with losses and costs: as the workstation counts it (env/charge_left.h).
double stored_worth_eur(const BatteryParameters& battery, double more_frac,
                        double price_eur_per_mwh);

/// What student and thresholds decide where nobody is in their way.
Action decide_undisturbed(const PricedCycle& cycle, double soc_frac,
                          const PriceThresholds& thresholds);

struct Driven {
  double earned_eur = 0;
  double soc_frac = 0;  ///< at the end
};

/// `decide(index of the cycle, SoC)`, over all cycles; after each `see(cycle, driven so far)`.
template <typename Decide, typename See>
Driven drive_through(std::span<const PricedCycle> cycles, double soc_frac,
                     const BatteryParameters& battery, const Decide& decide, const See& see) {
  Driven driven{.soc_frac = soc_frac};
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const BatteryStep next = full_step(battery, driven.soc_frac, decide(i, driven.soc_frac));
    driven.earned_eur += earned_eur(battery, next, cycles[i].paid_eur_per_mwh);
    driven.soc_frac = next.soc_frac;
    see(cycles[i], driven);
  }
  return driven;
}

}  // namespace bess
