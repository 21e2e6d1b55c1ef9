// Instants as local time of the market's zone, for people.
#pragma once

#include <cstdint>
#include <cstdio>

#include "shared/fixed_text.h"
#include "shared/local_time.h"

namespace bess {

/// "14:32".
inline FixedText<5> local_clock_text(std::int64_t utc_s) {
  const int minute = local_minute_of(utc_s).minute_of_day;
  char text[32];
  std::snprintf(text, sizeof text, "%02d:%02d", minute / 60, minute % 60);
  return text;
}

/// "2026-11-23 14:32".
inline FixedText<16> local_text(std::int64_t utc_s) {
  const LocalMinute now = local_minute_of(utc_s);
  char text[80];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d %02d:%02d", now.year, now.month, now.day,
                now.minute_of_day / 60, now.minute_of_day % 60);
  return text;
}

}  // namespace bess
