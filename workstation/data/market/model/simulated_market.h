// Simulated imbalance market with the statistics of Belgium in 2023: quarter-hours with system
// imbalance, marginal prices and the settled price by the exact formula, in whole cents, from
// market_parameters.h. Also its distance from the real market's statistics.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/data/market/model/minute_path.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

// From settled quarter-hours to the minute series by drawing a minute path for each.

/// Adds a plausible imbalance where the source has prices only: short if the price is above the
/// last day's median, long below, and so small that alpha is 0. Returns the number added.
std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours);

/// `quarter_hours` ascending in time, not empty. Absent quarter-hours stay missing minutes; without
/// an imbalance a quarter-hour gets its settled price but no indicative ones.
MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed);

// Simulated day-ahead prices: result of the previous day's auction for quarter-hours whose settled
// prices are given. Each hour's price is
//
//   D = profile by local hour + a (mean settled price of 3 hours on both sides - its mean)
//                             + b (the same of 12 hours) + noise
//
// with two autoregressions from hour to hour as noise. Fitted to Belgium, May 2024 to June 2025:
// correlation with the settled quarter-hours 0.21 and 0.38 (2024, 2025), of day-ahead prices with
// those an hour later 0.94 and 0.92, a day later 0.70 and 0.76. Hours are repeated in their
// quarter-hours, as was the case then.

/// The same seed gives the same prices on every machine. Needs the market's time zone.
DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed);

/// `period` starts at a local midnight. Needs the market's time zone (set_market_time_zone). The
/// same seed gives the same market on every machine.
std::vector<QuarterHour> simulate_quarter_hours(const UtcSpan& period, std::uint64_t seed);

}  // namespace bess
