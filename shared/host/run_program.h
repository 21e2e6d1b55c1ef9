// Another program, run to its end or to its time: given a text, its output taken; and words quoted
// for a shell. Needs poll and posix_spawn alone.
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
  /// Empty when it ran to its end; else why not, for a message.
  std::string trouble;
  int exit_code = -1;  ///< 128 + signal; -1: it did not run to its end
  std::string output;  ///< standard output
  std::string errors;  ///< standard error, where that is heard

  [[nodiscard]] bool is_well() const { return trouble.empty() && exit_code == 0; }
  /// Why it is not well, in one line: the last that it complained of.
  [[nodiscard]] std::string complaint() const;
};

/// `arguments[0]` is looked for in PATH unless it is a path. Killed, with all that it started, when
/// it takes longer than `time_ms_max`, says more than a megabyte, or within a tenth of a second
/// after it is not wanted any more. Its errors go where ours go. SIGPIPE must be ignored where
/// `input` is not empty: a program need not read what it is given.
ProgramResult run_program(const std::vector<std::string>& arguments, std::string_view input,
                          int time_ms_max, const std::stop_token& stop = {});

/// The same without an input, its errors taken too.
ProgramResult run_and_hear(const std::vector<std::string>& arguments, std::int64_t timeout_s);

}  // namespace bess
