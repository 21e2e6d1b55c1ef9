// The battery at the start: is it there, and is it the one that the configuration means? Nothing
// here writes to it, nothing prints.
#pragma once

#include <string>

#include "edge/battery/modbus_battery.h"
#include "edge/program/edge_clock.h"
#include "edge/settings/edge_config.h"

namespace bess {

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
