#include "shared/local_time.h"

#include <stdlib.h>
#include <time.h>

#include <chrono>

#include "shared/units_and_limits.h"

namespace bess {

void set_market_time_zone(const char* posix_rule) {
  setenv("TZ", posix_rule, 1);
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
  return std::int64_t{date.time_since_epoch().count()} * 86'400 + t.hour * 3'600 + t.minute * 60 +
         t.second;
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

}  // namespace bess
