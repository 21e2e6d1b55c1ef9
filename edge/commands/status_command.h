// `bess-edge status`: another process that reads what the controller publishes (status.json, the
// decision ring, the lock) and says how it is, to a person or to a program.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code of the process; with --follow it ends by a signal only.
int run_status_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
