// A simulated imbalance market of Belgium's 2023 kind: quarter-hours with system imbalance,
// marginal prices and the settled price by the exact formula, in whole cents. What it is made of:
// market_parameters.h.
#pragma once

#include <cstdint>
#include <vector>

#include "workstation/market/series/quarter_hour.h"

namespace bess {

struct SimulationPeriod {
  std::int64_t start_utc_s;  ///< a local midnight
  std::int64_t end_utc_s;    ///< exclusive
};

/// Needs the market's time zone (set_market_time_zone). The same seed gives the same market
/// everywhere.
std::vector<QuarterHour> simulate_quarter_hours(const SimulationPeriod& period, std::uint64_t seed);

}  // namespace bess
