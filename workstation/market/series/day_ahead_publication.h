// What is known of the day-ahead prices at a moment. The auction's result for a local day comes at
// noon of the day before; a price counts as known from 13:00 local time of that day on, or later
// where the file says that it came later. A file that claims an earlier time is not believed: only
// whoever asked at that time could know, and a price that is known too early is look-ahead.
#pragma once

#include <cstdint>
#include <vector>

#include "workstation/market/series/day_ahead.h"

namespace bess {

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
