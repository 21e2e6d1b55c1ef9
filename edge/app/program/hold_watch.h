// Hold watcher: reads the operator's files every second and publishes hold and cleared trips. A
// separate thread, because a blocked disk must not delay the control thread. After `start` it
// allocates nothing.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cstdint>

#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/restored_state.h"
#include "edge/core/control/hold.h"
#include "edge/core/memory/plain_thread.h"

namespace bess {

class HoldWatch {
 public:
  HoldWatch();
  HoldWatch(const HoldWatch&) = delete;
  HoldWatch& operator=(const HoldWatch&) = delete;
  ~HoldWatch();

  /// Reads the files once for the first control cycle, then in the background. `time_scale`: the
  /// period is one second of simulated time.
  void start(const StateFilePaths& paths, const StateFilePaths& cleared, std::int32_t time_scale);
  [[nodiscard]] const LatestHold& latest_hold() const { return latest_hold_; }

  /// Called by the control thread, never waits: whether the trip of this time is known to be
  /// cleared. The watcher checks it from the first call.
  bool is_cleared(std::int64_t trip_utc_s);

 private:
  void run();
  void look();

  void report_losses(const HoldReading& reading);

  StateFilePaths paths_;
  HoldReading reported_;
  StateFilePaths cleared_;
  std::atomic<std::int64_t> asked_trip_utc_s_{0};
  std::atomic<std::int64_t> cleared_trip_utc_s_{0};
  std::int64_t period_ns_ = 0;
  LatestHold latest_hold_;
  sem_t ending_;
  PlainThread thread_;
};

}  // namespace bess
