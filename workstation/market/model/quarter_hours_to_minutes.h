// From settled quarter-hours to the minute series: draws the minute path on each of them.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/market/series/quarter_hour.h"

namespace bess {

/// Gives quarter-hours without an imbalance a plausible one, for sources that publish prices only:
/// short where the price is above the median of the last day's, long below. Small enough that alpha
/// is 0. Returns how many it filled.
std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours);

/// `quarter_hours` ascending in time, not empty. Absent quarter-hours stay missing minutes; one
/// without an imbalance gets its settled price but no indicative ones.
MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed);

}  // namespace bess
