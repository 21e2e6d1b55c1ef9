// bess-edge release: ends an order that a controller which is gone has left in force.
#pragma once

#include "edge/battery/modbus_battery.h"
#include "edge/commands/command_line.h"
#include "edge/program/edge_clock.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code: 0 released and read back, 1 failed (one line on stderr), 2 without --yes.
int run_release_command(const CommandLine& command_line, const EdgeConfig& config,
                        ModbusBattery& battery, EdgeClock& clock);

}  // namespace bess
