// Another program, run to its end or to its time: given a text, its output taken.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct ProgramResult {
  /// Empty when it ran to its end; else why not, for a message.
  std::string trouble;
  int exit_code = -1;
  std::string output;  ///< standard output; errors go where ours go
};

/// `arguments[0]` is the program's path. Killed when it takes longer than `time_ms_max`, says more than a
/// megabyte, or within a tenth of a second after it is not wanted any more. SIGPIPE must be ignored: a program
/// need not read what it is given.
ProgramResult run_program(const std::vector<std::string>& arguments, std::string_view input,
                          int time_ms_max, const std::stop_token& stop = {});

}  // namespace bess
