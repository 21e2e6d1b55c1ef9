// bess-edge commission: runs the sign check on the real battery and stores its result.
#pragma once

#include "edge/battery/modbus_battery.h"
#include "edge/battery/modbus_meter.h"
#include "edge/commands/command_line.h"
#include "edge/program/edge_clock.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code: 0 passed and stored, 1 refused or failed (one line on stderr), 2 without --yes.
int run_commission_command(const CommandLine& command_line, const EdgeConfig& config,
                           ModbusBattery& battery, ModbusMeter& meter, EdgeClock& clock);

}  // namespace bess
