// Parser of a time in the market's local time: 14:32 (the latest), today 14:32, yesterday 14:32,
// yesterday (this time of day), 2026-11-23 14:32, 2h (ago); or UTC, unambiguous where an hour
// repeats: 2026-11-23T13:32:00Z.
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/records/why/explanation.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

/// Noon of the previous local day, also where the clock changed.
inline std::int64_t yesterday_utc_s(std::int64_t now_utc_s) {
  return local_midnight_utc_s(now_utc_s) - kSecondsPerDay / 2;
}

/// False for any other text.
inline bool parse_moment(std::string_view text, std::int64_t now_utc_s, std::int64_t& utc_s) {
  if (parse_utc(text, utc_s)) return true;
  std::int64_t ago_s = 0;
  if (text == "yesterday") text = "1d";
  if (parse_duration(text, ago_s)) {
    utc_s = now_utc_s - ago_s;
    return true;
  }
  CivilTime wall{};
  const auto utc_on_day_of = [&wall](std::int64_t day_utc_s) {
    const LocalMinute day = local_minute_of(day_utc_s);
    wall = {day.year, day.month, day.day, wall.hour, wall.minute, wall.second};
    return utc_from_local(wall);
  };
  for (const std::string_view day : {"today ", "yesterday "}) {
    if (!text.starts_with(day)) continue;
    std::string_view clock = text.substr(day.size());
    if (!detail::take_clock(clock, wall) || !clock.empty()) return false;
    utc_s = utc_on_day_of(day[0] == 'y' ? yesterday_utc_s(now_utc_s) : now_utc_s);
    return true;
  }
  std::string_view clock = text;
  if (detail::take_clock(clock, wall) && clock.empty()) {
    utc_s = utc_on_day_of(now_utc_s);
    if (utc_s > now_utc_s) utc_s = utc_on_day_of(yesterday_utc_s(now_utc_s));
    return true;
  }
  if (!detail::take_date(text, wall)) return false;
  if (!detail::take(text, ' ') && !detail::take(text, 'T')) return false;
  if (!detail::take_clock(text, wall) || !text.empty()) return false;
  utc_s = utc_from_local(wall);
  return true;
}

}  // namespace bess
