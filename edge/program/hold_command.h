// bess-edge hold: an operator's order with an end, left for the running controller to find.
#pragma once

#include "edge/program/command_line.h"
#include "edge/program/edge_config.h"

namespace bess {

/// Where a controller of this configuration looks for a hold.
FixedText<639> hold_path(const EdgeConfig& config);

/// Prints what will happen, and until when. Exit code: 0 done, 1 refused (one line on stderr).
int run_hold_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
