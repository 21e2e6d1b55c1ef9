// `bess-edge history`: which versions and weights this machine has run, and what became of them.
#pragma once

#include "edge/commands/command_line.h"

namespace bess {

/// A table, or with --json one list. Exit code 0; 1 where there is no history.
int run_history_command(const CommandLine& command_line);

}  // namespace bess
