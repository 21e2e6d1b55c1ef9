// What everything that talks to the battery begins with: memory as it must be, the student as it
// was exported, the battery for this process alone, a clock.
#pragma once

#include <optional>

#include "edge/program/edge_clock.h"
#include "edge/storage/run_locks.h"

namespace bess {

class DeviceSession {
 public:
  /// Before any thread is started. False when somebody else has the battery, or this machine is not
  /// fit; one line on stderr says it.
  bool begin(const EdgeConfig& config);

  /// After `begin`.
  EdgeClock& clock() { return *clock_; }
  RunLocks& locks() { return locks_; }

 private:
  RunLocks locks_;
  std::optional<EdgeClock> clock_;
};

}  // namespace bess
