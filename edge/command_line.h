// The options of bess-edge, parsed by hand: the edge carries no option library.
#pragma once

#include <cstdint>
#include <string>

namespace bess {

struct CommandLine {
  std::string config_path;
  bool dry_run = false;
  bool check = false;
  std::int64_t cycles = -1;  ///< -1 = until stopped
};

enum class CommandLineResult { kRun, kExitOk, kExitUsage };

/// Prints help, version or one line about what is wrong itself.
CommandLineResult parse_command_line(int argc, char** argv, CommandLine& command_line);

}  // namespace bess
