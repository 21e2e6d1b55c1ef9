// Another program, run to its end or to its deadline, its output kept. For the supervisor of upgrades alone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bess {

struct ProgramRun {
  int exit_code = -1;  ///< 128 + signal; -1: it could not be started, or was ended at its deadline
  std::string output;
  std::string errors;

  [[nodiscard]] bool is_well() const { return exit_code == 0; }
  /// The last line of what it complained of, or that it said nothing.
  [[nodiscard]] std::string complaint() const;
};

/// `arguments[0]` is looked for in PATH. Its input is empty. Output beyond 1 MiB is dropped.
ProgramRun run_program(std::vector<std::string> arguments, std::int64_t timeout_s);

}  // namespace bess
