// The command line of bess-edge, run in this process.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "edge/app/commands/command.h"

namespace bess {

struct EdgeOutput {
  int exit_code;
  std::string out, error;
  [[nodiscard]] std::string text() const { return out + error; }
};

inline EdgeOutput run_edge_words(const std::vector<std::string>& words) {
  std::vector<const char*> argv = {"bess-edge"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run_command_line(static_cast<int>(argv.size()), argv.data());
  std::string out = testing::internal::GetCapturedStdout();
  return {exit_code, std::move(out), testing::internal::GetCapturedStderr()};
}

}  // namespace bess
