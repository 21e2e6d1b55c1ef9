// Day-ahead prices: what the auction of the day before published for every quarter-hour of a local
// day. They are known long before they apply, and the imbalance price keeps near them: an outlook.
// File: CSV or .csv.gz beside the minute file, header
//   quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc
// UTC with Z, strictly ascending; # lines are provenance. `resolution_min` is that of the auction:
// 60 of an hour that is repeated in its four quarter-hours, as all were until 30 September 2025, 15
// since. An empty `published_utc` says that the time of publication is unknown; DayAheadPublication
// says what is known when.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/series/local_date.h"

namespace bess {

struct DayAheadSeries {
  std::int64_t start_utc_s = 0;               ///< first quarter-hour, a multiple of 900
  std::vector<double> eur_per_mwh;            ///< [quarter-hour] NaN = no price
  std::vector<std::uint8_t> resolution_min;   ///< [quarter-hour] 15, 30 or 60; 0 without a price
  std::vector<std::int64_t> published_utc_s;  ///< [quarter-hour] 0 = not noted

  [[nodiscard]] std::size_t size() const { return eur_per_mwh.size(); }
  [[nodiscard]] std::int64_t utc_s(std::size_t quarter_hour) const {
    return start_utc_s + kSecondsPerQuarterHour * static_cast<std::int64_t>(quarter_hour);
  }
  [[nodiscard]] std::int64_t end_utc_s() const { return utc_s(size()); }
};

struct DayAheadPrice {
  std::int64_t utc_s;
  double eur_per_mwh;
  int resolution_min;
  std::int64_t published_utc_s = 0;
};

/// Puts a price behind those that are there; what lies between is missing. False, and nothing done,
/// when it does not come after them or lies more than 40 years behind the first.
bool append_day_ahead(DayAheadSeries& series, const DayAheadPrice& price);

/// True of a text with a day-ahead file's header.
bool is_day_ahead_csv(std::string_view text);
/// Throws UserError naming the line.
DayAheadSeries parse_day_ahead_csv(std::string_view text, std::string_view name);
std::string format_day_ahead_csv(const DayAheadSeries& series, std::string_view provenance);
void write_day_ahead_file(const std::filesystem::path& path, const DayAheadSeries& series,
                          std::string_view provenance);

/// A local day with fewer prices than the calendar has quarter-hours for it: 92, 96 or 100.
struct IncompleteDay {
  std::string date;
  std::size_t prices, quarter_hours;
};
/// From the first to the last day of the series.
std::vector<IncompleteDay> incomplete_days(const DayAheadSeries& series);

// What is known of the day-ahead prices at a moment. The auction's result for a local day comes at
// noon of the day before; a price counts as known from 13:00 local time of that day on, or later
// where the file says that it came later. A file that claims an earlier time is not believed: only
// whoever asked at that time could know, and a price that is known too early is look-ahead.

inline constexpr int kDayAheadPublishedMin = 13 * 60;  ///< local minute of the day before

class DayAheadPublication {
 public:
  /// Needs the market's time zone.
  explicit DayAheadPublication(DayAheadSeries series, int published_min = kDayAheadPublishedMin);

  /// Price of the quarter-hour that holds the instant; NaN when none was published by `now_utc_s`.
  [[nodiscard]] double known_eur_per_mwh(std::int64_t utc_s, std::int64_t now_utc_s) const;
  /// When the next price of quarter-hours in [from, until) that is not known yet will be; far away
  /// if none.
  [[nodiscard]] std::int64_t next_known_utc_s(std::int64_t from_utc_s, std::int64_t until_utc_s,
                                              std::int64_t now_utc_s) const;
  [[nodiscard]] const DayAheadSeries& series() const { return series_; }

 private:
  DayAheadSeries series_;
  std::vector<std::int64_t> known_utc_s_;  ///< [quarter-hour]
};

}  // namespace bess
