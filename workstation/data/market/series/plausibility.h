// Whether prices can be what they claim to be: EUR/MWh of an imbalance market, one row a minute,
// one settled price a quarter-hour. Each finding has a name, so that a user who means it can accept
// it. What is wrong with the text of a file (no number, no time, disorder) its reader says; what is
// wrong with numbers that can be read is said here, once, for every command.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {

/// Every name that a finding may have; errors first, then warnings, then what is of day-ahead
/// prices alone.
inline constexpr std::array<std::string_view, 16> kFindingNames{
    "dates",       "row-step",      "constant",         "sentinel",      "price-unit",
    "price-range", "cut-end",       "settled-changes",  "overlap",       "gaps",
    "frozen",      "copied-column", "untrained-months", "unusual-price", "repeated-day",
    "shifted-day"};

struct Finding {
  std::string_view name;                ///< of kFindingNames
  bool is_error;                        ///< unless accepted; a warning otherwise
  std::string what;                     ///< what is wrong, and the mend
  std::optional<std::int64_t> utc_s{};  ///< the minute whose row shows it
};

/// All findings about a series, the most telling error first: a wrong unit is also a wrong range.
/// Honest data has none. Judgements of a whole column (unit, constant) need a day's worth of
/// prices.
std::vector<Finding> implausible(const MinuteSeries& series);

/// A text that does not end with a line end may have lost a part of its last row: an error when
/// that row contradicts its quarter-hour, otherwise a warning. `series` is what was read of it.
std::vector<Finding> implausible_end(std::string_view text, const MinuteSeries& series);

// Whether day-ahead prices can be what they claim to be, as plausibility.h judges minutes: the same
// names for the same mistakes, and three of their own. A day that repeats the one before in every
// quarter-hour is an old answer. Prices that follow the settled ones better a day later or earlier
// are filed under the wrong day; a day too early is look-ahead, and would look like a gain. Of the
// months of June 2024 to June 2025 eleven have the highest correlation as filed, April and May 2025
// one of 0.02 and 0.00 more a day off; the eight and the six months together have 0.21 and 0.38 as
// filed, 0.15 and 0.32 at most a day off.

std::vector<Finding> implausible_day_ahead(const DayAheadSeries& series);

/// Correlation of day-ahead prices with what the same quarter-hours were settled at, were every one
/// of them of so many days later; NaN of less than a day in common.
double day_ahead_correlation(const DayAheadSeries& day_ahead, const MinuteSeries& settled,
                             int days_later);

/// The finding `shifted-day`, of 80 days or more in common.
std::vector<Finding> shifted_day_ahead(const DayAheadSeries& day_ahead,
                                       const MinuteSeries& settled);

}  // namespace bess
