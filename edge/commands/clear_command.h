// `bess-edge clear`: a person has looked at why the supervision gave the battery back.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code: 0 cleared, or there is nothing to clear; 1 the log or the state folder is not
/// accessible; 2 --yes is missing.
int run_clear_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
