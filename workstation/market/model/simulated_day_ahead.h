// Day-ahead prices for a simulated imbalance market: what the auction of the day before would have
// said of quarter-hours whose settled prices are given. Each hour's price is
//
//   D = profile by local hour + a (mean settled price of 3 hours on both sides - its mean)
//                             + b (the same of 12 hours) + noise
//
// the noise two autoregressions from hour to hour. Fitted to Belgium, May 2024 to June 2025:
// correlation with the settled quarter-hours 0.21 and 0.38 (2024, 2025), of day-ahead prices with
// those an hour later 0.94 and 0.92, a day later 0.70 and 0.76. Hours are repeated in their
// quarter-hours, as they were then.
#pragma once

#include <cstdint>
#include <vector>

#include "workstation/market/series/day_ahead.h"

namespace bess {

/// The same seed gives the same prices everywhere. Needs the market's time zone.
DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed);

}  // namespace bess
