// [battery] of a configuration as `bess-train battery fit` writes it and `bess-train run` takes it:
// the simulator acts that battery.
#pragma once

#include <string>

#include "shared/battery_model.h"

namespace bess {

/// Sets what the file has of shared/battery_keys.h. Throws UserError naming file, line and key.
void read_battery_file(const std::string& path, BatteryParameters& battery);

}  // namespace bess
