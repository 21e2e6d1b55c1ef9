// Signals that end the program: each handler in a process of its own.
#include "workstation/runs/chain/folder_lock.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using testing::ExitedWithCode;

TEST(Interruption, EndsImmediatelyAndReportsWhatIsKept) {
  EXPECT_EXIT(
      {
        end_when_interrupted("months are kept");
        raise(SIGINT);
      },
      ExitedWithCode(3), "months are kept");
}

TEST(Interruption, OnceWatchedOnlyTheSecondEndsTheProgram) {
  EXPECT_EXIT(
      {
        watch_interruption();
        raise(SIGINT);
        if (!interruption()) _exit(1);
        raise(SIGINT);
        _exit(2);
      },
      ExitedWithCode(130), "");
}

TEST(Interruption, BeforeTheFirstLookThereIsNothingToSave) {
  EXPECT_EXIT(
      {
        end_when_interrupted();
        const auto interrupted = watch_from_first_call();
        raise(SIGTERM);
      },
      ExitedWithCode(3), "");
  EXPECT_EXIT(
      {
        end_when_interrupted();
        const auto interrupted = watch_from_first_call();
        if (interrupted()) _exit(1);
        raise(SIGTERM);
        _exit(interrupted() ? 0 : 2);
      },
      ExitedWithCode(0), "");
}

TEST(Interruption, RemovesHalfWrittenFiles) {
  const TemporaryFolder folder;
  const std::string half = folder.write("out.csv.part.1", "half");
  EXPECT_EXIT(
      {
        end_when_interrupted();
        const UnfinishedFile unfinished(half);
        raise(SIGINT);
      },
      ExitedWithCode(3), "");
  EXPECT_FALSE(std::filesystem::exists(half));
}

}  // namespace
}  // namespace bess
