// bess-edge commission: runs the sign check on the real battery and stores its result.
#pragma once

#include "edge/command_line.h"
#include "edge/edge_clock.h"
#include "edge/edge_config.h"

namespace bess {

/// Exit code: 0 passed and stored, 1 refused or failed (one line on stderr), 2 without --yes.
int run_commission_command(const CommandLine& command_line, const EdgeConfig& config,
                           ModbusBattery& battery, EdgeClock& clock);

}  // namespace bess
