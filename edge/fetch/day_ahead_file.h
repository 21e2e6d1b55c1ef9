// What is kept of day-ahead prices over a restart: one file in the state folder, a line a
// quarter-hour, replaced at once and checked as a whole.
//   # bess day-ahead 1: quarter-hour, hundredths of EUR/MWh, received
//   2026-11-23T23:00:00Z 4150 2026-11-23T11:57:12Z
//   # crc32=0123abcd
// Nothing here allocates.
#pragma once

#include <span>

#include "edge/fetch/day_ahead_book.h"

namespace bess {

inline constexpr const char* kDayAheadFileName = "day_ahead";

/// False with errno set.
bool keep_day_ahead(const char* path, const DayAheadBook& book);

/// How many prices came back; 0 where there is no file, or none that is whole: they are fetched
/// again.
int restore_day_ahead(const char* path, DayAheadBook& book);

}  // namespace bess
