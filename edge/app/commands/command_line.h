// Command line of bess-edge and all its commands.
#pragma once

namespace bess {

/// Runs the command; an error is one line on stderr. Returns the exit code of the process.
int run_command_line(int argc, const char* const* argv);

}  // namespace bess
