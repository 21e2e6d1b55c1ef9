// State that a run restores from the log of earlier runs, which may be empty.
#pragma once

#include "edge/core/loop/control_loop.h"

namespace bess {

/// Newest record, with the price level to start from.
inline CycleRecord take_over_of(const CycleRecord& newest, const PriceLevel& level) {
  CycleRecord before = newest;
  before.price_level = level;
  return before;
}

/// Supervision replays the last hours at a start, so that a kill between two readings hides no
/// finding. Control cycles before a trip are skipped: it is restored separately, or was cleared.
/// `Log`: bool read_back(std::int64_t records, CycleRecord&), 0 = the newest, false = unreadable.
template <typename Log, typename Loop>
void recall_cycles(const Log& log, std::int64_t now_utc_s, Loop& loop) {
  constexpr std::int64_t kRecalledS = 8 * 3'600;  // longest pause, and what led to it
  constexpr std::int64_t kCyclesMax = kRecalledS / kSecondsPerStep;
  CycleRecord record;
  std::int64_t cycles = 0;
  for (; cycles < kCyclesMax; ++cycles) {
    if (!log.read_back(cycles, record)) continue;
    if (record.is_tripped || now_utc_s - record.utc_s > kRecalledS) break;
  }
  while (cycles-- > 0) {
    if (log.read_back(cycles, record)) loop.recall(record);
  }
}

}  // namespace bess
