// Day-ahead prices: results of the previous day's auction for every quarter-hour of a local day.
// They are known long before delivery, and the imbalance price stays near them, so they serve as an
// outlook. File: CSV or .csv.gz next to the minute file, header
//   quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc
// UTC with Z, strictly ascending; # lines are provenance. `resolution_min` is that of the auction:
// 60 until 30 September 2025 (an hour repeated in four quarter-hours), 15 since then. An empty
// `published_utc` is an unknown time of publication; DayAheadPublication defines what is known
// when.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/day_ahead_rows.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

struct DayAheadSeries {
  std::int64_t start_utc_s = 0;               ///< first quarter-hour, a multiple of 900
  std::vector<double> eur_per_mwh;            ///< [quarter-hour] NaN = no price
  std::vector<std::uint8_t> resolution_min;   ///< [quarter-hour] 15, 30 or 60; 0 without a price
  std::vector<std::int64_t> published_utc_s;  ///< [quarter-hour] 0 = unknown

  [[nodiscard]] std::size_t size() const { return eur_per_mwh.size(); }
  [[nodiscard]] std::int64_t utc_s(std::size_t quarter_hour) const {
    return start_utc_s + kSecondsPerQuarterHour * static_cast<std::int64_t>(quarter_hour);
  }
  [[nodiscard]] std::int64_t end_utc_s() const { return utc_s(size()); }
};

/// Appends a price; the quarter-hours before it are missing. False without effect if it is not
/// after the last one or more than 40 years after the first.
bool append_day_ahead(DayAheadSeries& series, const DayAheadRow& price);

/// Whether the text has a day-ahead file's header.
bool is_day_ahead_csv(std::string_view text);
/// Throws UserError naming the line.
DayAheadSeries parse_day_ahead_csv(std::string_view text, std::string_view name);
std::string format_day_ahead_csv(const DayAheadSeries& series, std::string_view provenance);
void write_day_ahead_file(const std::filesystem::path& path, const DayAheadSeries& series,
                          std::string_view provenance);

/// A local day with fewer prices than its 92, 96 or 100 quarter-hours.
struct IncompleteDay {
  std::string date;
  std::size_t prices, quarter_hours;
};
/// From the first to the last day of the series.
std::vector<IncompleteDay> incomplete_days(const DayAheadSeries& series);

// Known day-ahead prices at an instant. The auction's result for a local day is published at noon
// of the previous day; a price counts as known from 13:00 local time of that day, or later if the
// file states so. Earlier times in a file are ignored: a price that is known too early is
// look-ahead.

inline constexpr int kDayAheadPublishedMin = 13 * 60;  ///< local minute of the previous day

class DayAheadPublication {
 public:
  /// Needs the market's time zone.
  explicit DayAheadPublication(DayAheadSeries series, int published_min = kDayAheadPublishedMin);

  /// Price of the quarter-hour that contains the instant; NaN if not published by `now_utc_s`.
  [[nodiscard]] double known_eur_per_mwh(std::int64_t utc_s, std::int64_t now_utc_s) const;
  /// Next publication of an unknown price of quarter-hours in [from, until); far away if there is
  /// none.
  [[nodiscard]] std::int64_t next_known_utc_s(std::int64_t from_utc_s, std::int64_t until_utc_s,
                                              std::int64_t now_utc_s) const;
  [[nodiscard]] const DayAheadSeries& series() const { return series_; }

 private:
  DayAheadSeries series_;
  std::vector<std::int64_t> known_utc_s_;  ///< [quarter-hour]
};

}  // namespace bess
