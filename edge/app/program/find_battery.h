// Battery search at the start: reachable, and the configured battery? Writes nothing to it.
#pragma once

#include <optional>
#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/settings/edge_config.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/device/battery/modbus_battery.h"

namespace bess {

/// After a failed internal check (edge/core/base/check.h) of this thread, orders 0 W and releases
/// the battery before the process ends. The battery must outlive the process.
void release_if_a_check_fails(ModbusBattery& battery);

/// Preparation of every command that uses the battery: memory, student check, battery lock, clock.
struct DeviceSession {
  /// Call before any thread starts. False with one line on stderr when the battery is in use, or
  /// this machine is not suitable.
  bool begin(const EdgeConfig& config);

  RunLocks locks;
  std::optional<EdgeClock> clock;  ///< set by `begin`
};

struct BatterySearch {
  Status status = Status::kOk;
  bool is_stranger = false;  ///< another device: no retry
  std::string trouble;       ///< address, reading, remedy
};

/// Failed identity check, with the reading.
std::string identity_text(const RegisterMap& map, const IdentityFailure& failure);

/// Read error, with the lost point (1 + index; 0 = none).
std::string reading_text(const EdgeConfig& config, ModbusBattery& battery, Status status,
                         int lost_point);

/// Raw values of the registers of the measurement and of active alarms.
std::string measured_text(const RegisterMap& map, const PointValues& live);

/// Checks that this is the configured battery.
BatterySearch identify_battery(const EdgeConfig& config, ModbusBattery& battery);

/// Tries until `start_timeout_s` or a stop request.
BatterySearch find_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock);

}  // namespace bess
