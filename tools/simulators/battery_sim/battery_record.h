// Battery trace: energy that the battery exchanged, one CSV row per simulated minute, for
// comparison with the decision log and the market. Written to a temporary file and renamed, so it
// is always complete.
#pragma once

#include <string>
#include <vector>

#include "tools/simulators/battery_sim/house_load.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

/// With a house two more columns: house_wh, and grid_wh = house_wh + energy_wh (import positive).
void write_battery_record(const std::string& path, const std::vector<MinuteRecord>& minutes,
                          const HouseLoad* house = nullptr);

/// `utc_ms,event,power_w,duration_s,soc`: every order and its end (order, stop, expiry).
void write_dispatch_events(const std::string& path, const SimulatedBattery& battery);

/// Read both files. Throw UserError naming file and line.
std::vector<MinuteRecord> read_battery_record(const std::string& path);
std::vector<DispatchEvent> read_dispatch_events(const std::string& path);

}  // namespace bess
