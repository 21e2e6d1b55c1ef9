// Planner with a limit on daily full cycles: fitted with the limit's shadow price as additional
// wear (foresight.h), so that the limit is met on average over the fitted days. The evaluation
// enforces it each day.
#pragma once

#include <vector>

#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {

/// Battery to plan with: `battery` itself without a limit.
template <typename Planner, typename... Options>
BatteryParameters battery_with_shadow_price(const MarketSteps& market,
                                            const std::vector<MarketDay>& days,
                                            const BatteryParameters& battery,
                                            const Options&... options) {
  BatteryParameters shadowed = battery;
  shadowed.cycles_per_day_max = 0;
  if (battery.cycles_per_day_max <= 0) return shadowed;
  ShadowPrice price;
  for (int trial = 0; trial <= kShadowPriceBisections; ++trial) {
    shadowed.wear_eur_per_mwh = battery.wear_eur_per_mwh + price.trial();
    Planner planner(market, days, shadowed, options...);
    const double start_frac = 0.5 * (battery.soc_min_frac + battery.soc_max_frac);
    const Evaluation run = evaluate(market, days, planner, {shadowed, start_frac, true});
    price.learn(run.cycles_per_day() <= battery.cycles_per_day_max);
    if (price.found() == 0) break;
  }
  shadowed.wear_eur_per_mwh = battery.wear_eur_per_mwh + price.found();
  return shadowed;
}

}  // namespace bess
