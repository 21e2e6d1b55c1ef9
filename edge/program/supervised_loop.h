// The control loop as a service: runs cycles until a stop is requested or enough are done, hands each
// record to the log and tells systemd about it, then leaves by the safe state.
#pragma once

#include <cstdint>

#include "edge/control/edge_clock.h"
#include "edge/log/event_log.h"
#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/service_notify.h"

namespace bess {

inline void write_farewell(bool is_ok, bool is_handed_over, bool in_control) {
  if (!in_control) {
    write_journal_line(JournalLevel::kNotice, "stopped: read-only, nothing was written");
  } else if (!is_ok) {
    write_journal_line(JournalLevel::kWarning,
                       "stopped: release failed, the battery's own timer ends it");
  } else {
    write_journal_line(JournalLevel::kNotice, is_handed_over
                                                  ? "stopped: handed over, the order stays in force"
                                                  : "stopped: battery released");
  }
}

/// Returns when the battery was given back; the last order keeps its whole step.
template <typename Loop>
void run_supervised(Loop& loop, std::int64_t cycles, EdgeClock& clock, EventLog& log,
                    ServiceNotify& notify, bool in_control) {
  constexpr std::int64_t kDrainNsMax = 5 * kNanosecondsPerSecond;
  CycleRecord record{};
  const HeapSeal seal;  // from here on this thread calls no allocator
  clock.wait_for_simulated_start();
  for (std::int64_t i = 0; i != cycles && loop.run_cycle(record); ++i) {
    log.write(record);
    notify.cycle_done(record);
  }
  clock.sleep_until_utc_ns((record.utc_s + kSecondsPerStep) * kNanosecondsPerSecond);
  notify.stopping();
  const bool is_handed_over = clock.hand_over_requested() && loop.hand_over(record);
  const Status status = is_handed_over ? Status::kOk : loop.stop(record);
  log.write(record);
  if (!log.drain(kDrainNsMax)) {
    report(JournalLevel::kWarning, "the disk is too slow: the last records are not logged");
  }
  write_farewell(status == Status::kOk, is_handed_over, in_control);
}

}  // namespace bess
