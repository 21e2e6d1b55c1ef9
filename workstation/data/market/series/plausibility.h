// Plausibility checks of price series: EUR/MWh of an imbalance market, one row per minute, one
// settled price per quarter-hour. A user can accept a finding by its name. Readers report errors of
// the text (no number, no time, disorder); these checks cover readable numbers, for all commands.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/data/market/series/day_ahead.h"

namespace bess {

// Gaps: time intervals without a price.

struct Gap {
  std::int64_t from_utc_s;
  std::int64_t until_utc_s;  ///< exclusive
  [[nodiscard]] std::int64_t minutes() const { return (until_utc_s - from_utc_s) / 60; }
};

/// Intervals of NaN in a series with one value every `step_s` seconds.
std::vector<Gap> gaps_in(std::span<const double> values, std::int64_t start_utc_s,
                         std::int64_t step_s);
std::int64_t minutes_in(const std::vector<Gap>& gaps);

/// "settled price: 3 gaps, 45 minutes missing" and the longest of them, one per line.
std::string describe_gaps(std::string_view what, std::vector<Gap> gaps);

/// Every finding's name: errors, then warnings, then findings of day-ahead prices only.
inline constexpr std::array<std::string_view, 16> kFindingNames{
    "dates",       "row-step",      "constant",         "sentinel",      "price-unit",
    "price-range", "cut-end",       "settled-changes",  "overlap",       "gaps",
    "frozen",      "copied-column", "untrained-months", "unusual-price", "repeated-day",
    "shifted-day"};

struct Finding {
  std::string_view name;                ///< one of kFindingNames
  bool is_error;                        ///< unless accepted; a warning otherwise
  std::string what;                     ///< what is wrong, and the remedy
  std::optional<std::int64_t> utc_s{};  ///< the minute whose row shows it
};

/// All findings of a series, the most specific error first: a wrong unit is also a wrong range.
/// Correct data has none. Checks of a whole column (unit, constant) need one day of prices.
std::vector<Finding> implausible(const MinuteSeries& series);

/// A text without a final line end may have lost a part of its last row: an error if that row
/// contradicts its quarter-hour, otherwise a warning. `series` is the parsed text.
std::vector<Finding> implausible_end(std::string_view text, const MinuteSeries& series);

// Plausibility checks of day-ahead prices: the same names for the same errors, and two additional
// ones. A day that repeats the previous one in every quarter-hour is an old answer. Prices that
// follow the settled ones better a day later or earlier are filed under the wrong day; a day too
// early is look-ahead and would show a false gain. Of the months June 2024 to June 2025 eleven have
// the highest correlation as filed, April and May 2025 one that is 0.02 and 0.00 higher a day off;
// the eight and the six months together have 0.21 and 0.38 as filed, at most 0.15 and 0.32 a day
// off.

std::vector<Finding> implausible_day_ahead(const DayAheadSeries& series);

/// Correlation of day-ahead prices, shifted by `days`, with the settled prices of the same
/// quarter-hours; NaN for less than a day in common.
double day_ahead_correlation(const DayAheadSeries& day_ahead, const MinuteSeries& settled,
                             int days_later);

/// The finding `shifted-day`, for at least 80 common days.
std::vector<Finding> shifted_day_ahead(const DayAheadSeries& day_ahead,
                                       const MinuteSeries& settled);

// Price input gate: implausible prices are errors with file and row. Warnings and accepted errors
// are one line each on standard error.

/// Names of accepted findings: their errors become warnings.
class AcceptedFindings {
 public:
  AcceptedFindings() = default;
  /// `list` is NAME[,NAME]; throws UserError for an unknown name.
  explicit AcceptedFindings(std::string_view list);
  /// For commands that only describe prices.
  static AcceptedFindings all();
  [[nodiscard]] bool accepts(std::string_view name) const;

 private:
  std::vector<std::string> names_;
};

/// Text of the prices, so that a finding can name the row.
struct PriceText {
  std::string name;
  std::string_view text;
};

/// Throws UserError for the first error that is not accepted; prints the others, one per line.
void judge(const std::vector<Finding>& findings, const AcceptedFindings& accepted,
           const std::vector<PriceText>& texts);

/// Row number of a time, counted from 1 with comments and header; 0 if not found.
std::size_t row_of_time(std::string_view text, std::int64_t utc_s);

/// Reads a minute file and checks it.
MinuteSeries read_judged_minutes(const std::filesystem::path& path,
                                 const AcceptedFindings& accepted);
/// Checks the series of a minute file's text.
void judge_minutes(const MinuteSeries& series, const PriceText& text,
                   const AcceptedFindings& accepted);

}  // namespace bess
