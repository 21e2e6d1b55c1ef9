// bess-edge hold: an operator's order with an end, left for the running controller to find.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Prints what will happen, and until when. Exit code: 0 done, 1 refused (one line on stderr).
int run_hold_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
