#include "shared/local_time.h"

#include <stdlib.h>
#include <time.h>

#include <chrono>
#include <cstdio>

#include "shared/units_and_limits.h"

namespace bess {

void set_market_time_zone() {
  setenv("TZ", kBrusselsTimeZone, 1);
  tzset();
}

LocalMinute local_minute_of(std::int64_t utc_s) {
  const time_t instant = static_cast<time_t>(utc_s);
  tm local{};
  localtime_r(&instant, &local);
  const int minute_of_day = local.tm_hour * 60 + local.tm_min;
  return {.year = local.tm_year + 1900,
          .month = local.tm_mon + 1,
          .day = local.tm_mday,
          .minute_of_day = minute_of_day,
          .quarter_hour = minute_of_day / kMinutesPerQuarterHour,
          .minute_of_quarter_hour = minute_of_day % kMinutesPerQuarterHour};
}

std::int64_t utc_from_civil(const CivilTime& t) {
  using namespace std::chrono;
  const sys_days date = year{t.year} / t.month / t.day;
  return std::int64_t{date.time_since_epoch().count()} * kSecondsPerDay + t.hour * 3'600 +
         t.minute * 60 + t.second;
}

std::int64_t utc_from_local(const CivilTime& wall) {
  const std::int64_t wall_s = utc_from_civil(wall);
  const auto shown_ahead_s = [](std::int64_t utc_s) {
    const LocalMinute local = local_minute_of(utc_s);
    return utc_from_civil({.year = local.year,
                           .month = local.month,
                           .day = local.day,
                           .hour = local.minute_of_day / 60,
                           .minute = local.minute_of_day % 60,
                           .second = 0}) -
           utc_s / 60 * 60;
  };
  // The offset of the previous day applies before a clock change, that of the next day after it.
  const std::int64_t before = wall_s - shown_ahead_s(wall_s - kSecondsPerDay);
  if (before + shown_ahead_s(before) == wall_s) return before;
  const std::int64_t after = wall_s - shown_ahead_s(wall_s + kSecondsPerDay);
  return after + shown_ahead_s(after) == wall_s ? after : before;
}

std::int64_t local_midnight_utc_s(std::int64_t utc_s, int days_later) {
  const LocalMinute local = local_minute_of(utc_s);
  const std::int64_t day_s = utc_from_civil({local.year, local.month, local.day, 0, 0, 0});
  return utc_from_local(civil_from_utc(day_s + std::int64_t{days_later} * kSecondsPerDay));
}

CivilTime civil_from_utc(std::int64_t utc_s) {
  using namespace std::chrono;
  const sys_seconds instant{seconds{utc_s}};
  const sys_days date = floor<days>(instant);
  const year_month_day ymd{date};
  const int second_of_day = static_cast<int>((instant - date).count());
  return {static_cast<int>(ymd.year()),
          static_cast<int>(static_cast<unsigned>(ymd.month())),
          static_cast<int>(static_cast<unsigned>(ymd.day())),
          second_of_day / 3'600,
          second_of_day / 60 % 60,
          second_of_day % 60};
}

FixedText<5> local_clock_text(std::int64_t utc_s) {
  const int minute = local_minute_of(utc_s).minute_of_day;
  char text[32];
  std::snprintf(text, sizeof text, "%02d:%02d", minute / 60, minute % 60);
  return text;
}

FixedText<16> local_text(std::int64_t utc_s) {
  const LocalMinute now = local_minute_of(utc_s);
  char text[80];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d %02d:%02d", now.year, now.month, now.day,
                now.minute_of_day / 60, now.minute_of_day % 60);
  return text;
}

}  // namespace bess
