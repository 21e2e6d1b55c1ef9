// How bess-train ends: exit codes that scripts rely on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using testing::HasSubstr;

TEST(Program, OutputThatCannotBeWrittenIsAnError) {
  if (!std::filesystem::is_character_file("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full, which is absent";
  }
  ChildProcess program({"/bin/sh", "-c", BESS_TRAIN_PROGRAM " config > /dev/full"});
  EXPECT_THAT(program.read_all(), HasSubstr("cannot write to the standard output"));
  EXPECT_EQ(program.wait(), 1);
}

TEST(Program, CtrlCEndsACommandThatHasNothingToSave) {
  const TemporaryFolder folder;
  const auto out = folder.file("market.csv.gz");
  ChildProcess program({BESS_TRAIN_PROGRAM, "prices", "simulate", "--days", "7000", "--out", out});
  ASSERT_TRUE(program.catches(SIGINT));  // far too soon for 7,000 days
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 3);
  EXPECT_THAT(program.read_all(), HasSubstr("interrupted"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace bess
