// Output of a bess-train command, run in this process.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "shared/host/command_line.h"
#include "workstation/cli/commands.h"

namespace bess {

struct CommandOutput {
  std::string output, errors;
};

inline CommandOutput output_of_command(const std::string& arguments) {
  CommandLine command_line("bess-train", "", "");
  ProgramCommand root = command_line.root();
  add_commands(root);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  command_line.parse(arguments);
  std::string errors = testing::internal::GetCapturedStderr();
  return {testing::internal::GetCapturedStdout(), std::move(errors)};
}

}  // namespace bess
