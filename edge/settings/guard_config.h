// [guard]: what no order may break, and how much a day may wear the battery.
#pragma once

#include "edge/settings/battery_config.h"

namespace bess {

/// `battery`, and its power in `control`, must be known: what a day may hold follows from both.
void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control);

}  // namespace bess
