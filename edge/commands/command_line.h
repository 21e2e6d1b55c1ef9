// The command line of bess-edge, of all its commands.
#pragma once

#include "edge/commands/command.h"

namespace bess {

/// Does what the words say; what is wrong with them is one line on stderr. The exit code of the
/// process.
int run_command_line(Words words);

/// What `bess-edge --help` prints: the help of a run, with a row for each command.
std::string general_help();

}  // namespace bess
