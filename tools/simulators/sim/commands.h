// Subcommands of bess-sim: each declares its options and help, and runs as a callback.
#pragma once

#include <string>

#include "shared/battery_model.h"
#include "shared/host/command_line.h"

namespace bess {

void add_battery_command(ProgramCommand& app);
void add_market_command(ProgramCommand& app);
void add_settle_command(ProgramCommand& app);
void add_site_command(ProgramCommand& app);

/// Declares --power-w and --capacity-wh.
inline void add_rating_options(ProgramCommand& command, BatteryParameters& battery) {
  command.option("--power-w", battery.power_w_max, "rated power, W").positive().with_default();
  command.option("--capacity-wh", battery.capacity_wh, "capacity, Wh").positive().with_default();
}

/// Battery of `bess-sim battery --battery`: reads the keys of shared/battery_keys.h in [battery] of
/// a configuration. Throws UserError naming file, line and key.
void read_battery_file(const std::string& path, BatteryParameters& battery);

}  // namespace bess
