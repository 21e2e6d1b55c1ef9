// `bess-edge log`: prints the decision log from the ring in the state folder, as text or CSV.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code of the process.
int run_log_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
