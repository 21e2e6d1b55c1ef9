// Output of a program for one command line, after it has ended.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/host/child_process.h"

namespace bess {

/// The words, followed by more.
inline std::vector<std::string> joined(std::vector<std::string> words,
                                       const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

struct ProgramOutput {
  int exit_code;
  std::string text;
};

/// Waits for its end. `arguments`: the program first.
inline ProgramOutput answer_of(std::vector<std::string> arguments) {
  ChildProcess child(std::move(arguments));
  std::string text = child.read_all();
  return {child.wait(), std::move(text)};
}

}  // namespace bess
