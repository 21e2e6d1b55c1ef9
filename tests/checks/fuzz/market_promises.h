// Invariants of the rows that a reader of market files accepts.
#pragma once

#include <string_view>

#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {

inline void check_series(const MinuteSeries& series) {
  must(series.start_utc_s % 60 == 0, "a series starts on a whole minute");
  must(series.indicative.size() == series.settled.size(), "both prices for each minute");
  constexpr std::size_t kMinutesMax = 100'000;  // years between two rows only cost time
  if (series.size() > kMinutesMax) return;
  const std::string written = format_minute_csv(series, "");
  must(format_minute_csv(parse_minute_csv(written, "written"), "") == written,
       "what is written reads back to the same");
}

/// Reader and join may throw a UserError; accepted rows satisfy the invariants.
template <typename Parse>
void check_market_reader(Parse parse, std::string_view text) {
  static const bool time_zone_set = (set_market_time_zone(), true);
  (void)time_zone_set;
  MinuteSeries series;
  try {
    series = join_market(parse(text, "fuzz"), "fuzz").series;
  } catch (const UserError&) {
    return;
  }
  check_series(series);
}

inline void check_minute_reader(std::string_view text) {
  MinuteSeries series;
  try {
    series = parse_minute_csv(text, "fuzz");
  } catch (const UserError&) {
    return;
  }
  check_series(series);
}

}  // namespace bess
