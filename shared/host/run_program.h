// Execution of another program with input, output and time limit; and quoting for a shell. Needs
// only poll and posix_spawn.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

// A word of a command line, quoted where a shell needs it.

inline std::string shell_word(const std::string& word) {
  const bool is_plain = !word.empty() && word.find_first_not_of(
                                             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                             "0123456789_-./:,=+@%") == word.npos;
  if (is_plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

struct ProgramResult {
  /// Error message; empty if it ran to its end.
  std::string trouble;
  int exit_code = -1;  ///< 128 + signal; -1: did not run to its end
  std::string output;  ///< standard output
  std::string errors;  ///< standard error, if captured

  [[nodiscard]] bool is_well() const { return trouble.empty() && exit_code == 0; }
  /// Error in one line: the last line of its error output.
  [[nodiscard]] std::string complaint() const;
};

/// `arguments[0]` is searched in PATH unless it is a path. The program and its children are killed
/// after `time_ms_max`, after 1 MiB of output, or within 0.1 s after a stop request. Standard error
/// is inherited. With `input` the caller must ignore SIGPIPE, because a program need not read it.
ProgramResult run_program(const std::vector<std::string>& arguments, std::string_view input,
                          int time_ms_max, const std::stop_token& stop = {});

/// The same without input, capturing standard error.
ProgramResult run_and_capture(const std::vector<std::string>& arguments, std::int64_t timeout_s);

}  // namespace bess
