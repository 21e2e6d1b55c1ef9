// The battery at the start: is it there, and is it the one that the configuration means? Nothing
// here writes to it, nothing prints.
#pragma once

#include <optional>
#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/settings/edge_config.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/device/battery/modbus_battery.h"

namespace bess {

// A broken promise of the program itself (edge/core/base/check.h): the battery gets 0 W and is
// released before the process ends.

/// From now on, of this battery, if it is this thread whose check fails. The battery must outlive
/// the process.
void release_if_a_check_fails(ModbusBattery& battery);

// What everything that talks to the battery begins with: memory as it must be, the student as it
// was exported, the battery for this process alone, a clock.

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

struct BatterySearch {
  Status status = Status::kOk;
  bool is_stranger = false;  ///< it answers as another device, and will go on doing so
  std::string trouble;       ///< where it was looked for, what was read, what mends it
};

/// Which identity check failed, and what was read there.
std::string identity_text(const RegisterMap& map, const IdentityFailure& failure);

/// Why the battery could not be read, with the point that was lost (1 + index; 0 = none).
std::string reading_text(const EdgeConfig& config, ModbusBattery& battery, Status status,
                         int lost_point);

/// The registers that decided the measurement, and alarms that hold, with their raw values.
std::string measured_text(const RegisterMap& map, const LivePoints& live);

/// Proves that this is the configured battery.
BatterySearch identify_battery(const EdgeConfig& config, ModbusBattery& battery);

/// Tries until `start_timeout_s` is over, or a stop is asked for.
BatterySearch find_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock);

}  // namespace bess
