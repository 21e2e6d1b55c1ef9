// Conversion of UTC instants to local wall-clock minutes [SPEC 2]. All times are stored in UTC
// seconds; qh, mo and T_qh are local, so a day has 92, 96 or 100 quarter-hours. Uses localtime_r
// with a POSIX zone rule, set once at start-up: needs no tzdata on the target, and no allocation
// afterwards.
#pragma once

#include <cstdint>

#include "shared/fixed_text.h"

namespace bess {

/// Belgium: CET, summer time from the last Sunday of March to the last Sunday of October.
inline constexpr const char* kBrusselsTimeZone = "CET-1CEST,M3.5.0,M10.5.0/3";

struct LocalMinute {
  int year;
  int month;                   ///< 1..12
  int day;                     ///< 1..31
  int minute_of_day;           ///< 0..1439, wall clock
  int quarter_hour;            ///< qh 0..95, wall clock
  int minute_of_quarter_hour;  ///< T_qh 0..14
};

/// Sets TZ for the process (setenv + tzset). Call once, before any thread is started.
void set_market_time_zone();

/// Local wall-clock minute of a UTC instant in seconds since 1970.
LocalMinute local_minute_of(std::int64_t utc_s);

struct CivilTime {
  int year, month, day, hour, minute, second;
};

/// UTC of a local time; of a repeated hour the first, of a skipped hour as continued from the
/// previous hour.
std::int64_t utc_from_local(const CivilTime& wall);

/// Local midnight that begins the day `days_later` days after that of `utc_s`.
std::int64_t local_midnight_utc_s(std::int64_t utc_s, int days_later = 0);

/// Seconds since 1970 of a UTC calendar time (proleptic Gregorian); fields must be in range.
std::int64_t utc_from_civil(const CivilTime& t);
CivilTime civil_from_utc(std::int64_t utc_s);

/// Local day as one number, 20231126, for ordering and lookup.
constexpr std::int32_t local_day_of(const LocalMinute& now) {
  return (now.year * 100 + now.month) * 100 + now.day;
}
inline std::int32_t local_day_at(std::int64_t utc_s) {
  return local_day_of(local_minute_of(utc_s));
}

// Instants as local time of the market's zone, for people.

/// "14:32".
FixedText<5> local_clock_text(std::int64_t utc_s);
/// "2026-11-23 14:32".
FixedText<16> local_text(std::int64_t utc_s);

}  // namespace bess
