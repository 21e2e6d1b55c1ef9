// bess-train as a user runs it, in a folder of the test. For targets that define
// BESS_TRAIN_PROGRAM.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/host/file.h"
#include "tests/support/program_output.h"
#include "tests/support/temporary_folder.h"

namespace bess {

struct CommandResult {
  int exit_code;
  std::string output;
};

inline CommandResult run_train(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), BESS_TRAIN_PROGRAM);
  auto [exit_code, output] = answer_of(std::move(arguments));
  return {exit_code, std::move(output)};
}

class TrainCommands : public testing::Test {
 protected:
  using Result = CommandResult;

  static Result run(std::vector<std::string> arguments) { return run_train(std::move(arguments)); }
  /// Output of a command that ends with this code.
  static std::string said(std::vector<std::string> arguments, int exit_code = 0) {
    const Result result = run(std::move(arguments));
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    return result.output;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string written(const std::string& name, std::string_view text) const {
    write_file(path(name), text);
    return path(name);
  }

  TemporaryFolder folder_;
};

}  // namespace bess
