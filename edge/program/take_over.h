// What a run takes over from the log of the runs before, which may be empty.
#pragma once

#include "edge/loop/control_loop.h"

namespace bess {

/// When the power of a record's order was ordered first, to some seconds: the battery was read a little before its tick.
inline std::int64_t ordered_since_utc_s(const CycleRecord& record) {
  const FollowedOrder& before = record.followed;
  const bool goes_on = before.is_judged && before.power_w == record.ordered_power_w;
  return goes_on ? record.utc_s - before.age_s : record.utc_s;
}

/// `trip`: the one in force, which another log than that of `before` may know.
inline TakeOver take_over_of(const CycleRecord& before, const Trip& trip, const PriceLevel& level) {
  return {.throughput = before.throughput,
          .price_level = level,
          .trip = trip,
          .lost_orders = before.lost_orders,
          .reversals = before.reversals,
          .last_full_day = last_full_day_of(before.utc_s, before.days_since_full),
          .site = before.site,
          .standing_price = before.standing_price,
          .ordered_power_w = before.ordered_power_w,
          .ordered_since_utc_s = ordered_since_utc_s(before),
          .utc_s = before.utc_s};
}

/// Supervision judges at a start what it has judged in the last hours, so that a kill between two readings
/// hides no finding. A trip ends what is recalled: it is taken over by itself, or a person has looked.
/// `Log`: bool read_back(std::int64_t records, CycleRecord&), 0 = the newest, false = not readable.
template <typename Log, typename Loop>
void recall_cycles(const Log& log, std::int64_t now_utc_s, Loop& loop) {
  constexpr std::int64_t kRecalledS = 8 * 3'600;  // the longest pause, and what led to it
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
