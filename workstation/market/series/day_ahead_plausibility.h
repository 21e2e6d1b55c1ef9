// Whether day-ahead prices can be what they claim to be, as plausibility.h judges minutes: the same
// names for the same mistakes, and three of their own. A day that repeats the one before in every
// quarter-hour is an old answer. Prices that follow the settled ones better a day later or earlier
// are filed under the wrong day; a day too early is look-ahead, and would look like a gain. Of the
// months of June 2024 to June 2025 eleven have the highest correlation as filed, April and May 2025
// one of 0.02 and 0.00 more a day off; the eight and the six months together have 0.21 and 0.38 as
// filed, 0.15 and 0.32 at most a day off.
#pragma once

#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/market/series/day_ahead.h"
#include "workstation/market/series/plausibility.h"

namespace bess {

std::vector<Finding> implausible_day_ahead(const DayAheadSeries& series);

/// Correlation of day-ahead prices with what the same quarter-hours were settled at, were every one
/// of them of so many days later; NaN of less than a day in common.
double day_ahead_correlation(const DayAheadSeries& day_ahead, const MinuteSeries& settled,
                             int days_later);

/// The finding `shifted-day`, of 80 days or more in common.
std::vector<Finding> shifted_day_ahead(const DayAheadSeries& day_ahead,
                                       const MinuteSeries& settled);

}  // namespace bess
