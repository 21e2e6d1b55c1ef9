// The command line of bess-edge, run in this process.
#pragma once

#include <string>
#include <vector>

#include "edge/app/commands/command_line.h"

namespace bess {

inline int run_edge_words(const std::vector<std::string>& words) {
  std::vector<const char*> argv = {"bess-edge"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  return run_command_line(static_cast<int>(argv.size()), argv.data());
}

}  // namespace bess
