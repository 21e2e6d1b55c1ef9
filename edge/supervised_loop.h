// The control loop as a service: runs cycles until a stop is requested or enough are done, hands each
// record to the log and tells systemd about it, then leaves by the safe state.
#pragma once

#include <cstdint>

#include "edge/edge_clock.h"
#include "edge/event_log.h"
#include "edge/journal.h"
#include "edge/service_notify.h"

namespace bess {

/// Returns when the battery was given back; the last order keeps its whole step.
template <typename Loop>
void run_supervised(Loop& loop, std::int64_t cycles, EdgeClock& clock, EventLog& log,
                    ServiceNotify& notify) {
  constexpr std::int64_t kDrainNsMax = 5 * kNanosecondsPerSecond;
  CycleRecord record{};
  clock.wait_for_simulated_start();
  for (std::int64_t i = 0; i != cycles && loop.run_cycle(record); ++i) {
    log.write(record);
    notify.cycle_done(record);
  }
  clock.sleep_until_utc_ns((record.utc_s + kSecondsPerStep) * kNanosecondsPerSecond);
  notify.stopping();
  const Status status = loop.stop(record);
  log.write(record);
  if (!log.drain(kDrainNsMax)) {
    report(JournalLevel::kWarning, "the disk is too slow: the last records are not logged");
  }
  const bool is_released = status == Status::kOk;
  write_journal_line(is_released ? JournalLevel::kNotice : JournalLevel::kWarning,
                     is_released ? "stopped: battery released"
                                 : "stopped: release failed, the battery's own timer ends it");
}

}  // namespace bess
