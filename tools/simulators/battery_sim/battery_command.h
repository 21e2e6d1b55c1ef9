// Battery of `bess-sim battery --battery`: the [battery] of a configuration.
#pragma once

#include <string>

#include "shared/battery_model.h"

namespace bess {

/// Reads the keys of shared/battery_keys.h. Throws UserError naming file, line and key.
void read_battery_file(const std::string& path, BatteryParameters& battery);

}  // namespace bess
