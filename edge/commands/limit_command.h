// `bess-edge limit`: caps the battery's power for a while, by the file that [limits] names. What a
// site controller that speaks no such file calls, and a person.
#pragma once

#include "edge/commands/command_line.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Exit code of the process.
int run_limit_command(const CommandLine& command_line, const EdgeConfig& config);

}  // namespace bess
