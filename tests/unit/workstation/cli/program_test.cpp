// Exit codes of bess-train, as scripts use them.
#include <gmock/gmock.h>
#include <signal.h>

#include <cstring>
#include <filesystem>

#include "shared/host/toml_document.h"
#include "tests/support/signal_handler.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/toml_mistakes.h"
#include "tests/support/train_commands.h"

namespace bess {
namespace {

TEST(Program, OutputThatCannotBeWrittenIsAnError) {
  if (!std::filesystem::is_character_file("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full, which is absent";
  }
  ChildProcess program({"/bin/sh", "-c", BESS_TRAIN_PROGRAM " config > /dev/full"});
  EXPECT_THAT(program.read_all(), Names(std::string("bess-train ") + std::strerror(ENOSPC)));
  EXPECT_EQ(program.wait(), 1);
}

TEST(Program, AByteOrderMarkBeforeTheConfigurationIsSkipped) {
  const TemporaryFolder folder;
  const std::string config = folder.write("run.toml", "\xEF\xBB\xBF[train]\nsteps = 7\n");
  const CommandResult result = run_train({"config", "--config", config});
  EXPECT_THAT(result.output, testing::HasSubstr("steps = 7 "));
  EXPECT_EQ(result.exit_code, 0);
}

TEST(Program, CtrlCEndsACommandThatHasNothingToSave) {
  const TemporaryFolder folder;
  const auto out = folder.file("market.csv.gz");
  ChildProcess program({BESS_TRAIN_PROGRAM, "prices", "simulate", "--days", "7000", "--out", out});
  ASSERT_TRUE(catches(program.pid(), SIGINT));  // far too soon for 7,000 days
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 3);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace bess
