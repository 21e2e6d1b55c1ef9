// The command line of bess-edge, of all its commands.
#pragma once

namespace bess {

/// Does what the words say; what is wrong with them is one line on stderr. The exit code of the
/// process.
int run_command_line(int argc, const char* const* argv);

}  // namespace bess
