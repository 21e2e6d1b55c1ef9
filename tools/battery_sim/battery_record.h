// The battery's own account of what it exchanged: one CSV row per simulated minute, to be held
// against the edge's log and the market. Written beside and renamed, so a file under its name is
// always complete.
#pragma once

#include <string>

#include "tools/battery_sim/simulated_battery.h"

namespace bess {

void write_battery_record(const std::string& path, const SimulatedBattery& battery);

}  // namespace bess
