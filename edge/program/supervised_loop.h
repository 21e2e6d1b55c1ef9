// The control loop as a service: runs cycles until a stop is requested or enough are done, hands
// each record to the log and tells systemd about it, then leaves by the safe state.
#pragma once

#include <cstdint>

#include "edge/log/event_log.h"
#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/edge_clock.h"
#include "edge/program/hold_watch.h"
#include "edge/program/service_notify.h"

namespace bess {

inline void write_farewell(const CycleRecord& last, bool is_in_control, bool ends_by_itself) {
  if (!is_in_control) {
    write_journal_line(JournalLevel::kNotice, "stopped: read-only, nothing was written");
  } else if (last.reason == Reason::kHandOver) {
    write_journal_line(JournalLevel::kNotice, "stopped: handed over, the order stays in force");
  } else if (last.battery_status != Status::kOk && !ends_by_itself) {
    write_journal_line(JournalLevel::kError,
                       "stopped: release failed, and this battery has no timer: it may follow its "
                       "last order for ever; start again, or set it back by hand");
  } else if (last.battery_status != Status::kOk) {
    write_journal_line(JournalLevel::kWarning,
                       "stopped: release failed, the battery's own timer ends it");
  } else {
    write_journal_line(JournalLevel::kNotice, last.written ? "stopped: battery released"
                                                           : "stopped: no order was in force");
  }
}

/// The last order keeps its whole step. False when the battery could not be given back.
/// `people` knows when one of them has ended a trip.
template <typename Loop>
bool run_supervised(Loop& loop, std::int64_t cycles, EdgeClock& clock, EventLog& log,
                    ServiceNotify& notify, HoldWatch& people) {
  constexpr std::int64_t kDrainNsMax = 5 * kNanosecondsPerSecond;
  CycleRecord record{};
  const HeapSeal seal;  // from here on this thread calls no allocator
  clock.wait_for_simulated_start();
  for (std::int64_t i = 0; i != cycles && loop.run_cycle(record); ++i) {
    log.write(record);
    notify.cycle_done(record);
    if (loop.trip().is_set() && people.is_cleared(loop.trip().utc_s)) loop.clear_trip();
  }
  loop.finish_step();
  notify.stopping();
  if (!clock.hand_over_requested() || !loop.hand_over(record)) loop.stop(record);
  log.write(record);
  if (!log.drain(kDrainNsMax)) {
    report(JournalLevel::kWarning, "the disk is too slow: the last records are not logged");
  }
  write_farewell(record, loop.is_in_control(), loop.order_ends_by_itself());
  return record.battery_status == Status::kOk;
}

}  // namespace bess
