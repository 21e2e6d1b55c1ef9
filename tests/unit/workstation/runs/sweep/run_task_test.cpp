// Tasks with trivial work: published files and their order, and the remains when they are killed at
// any moment, run twice in parallel, or may not write.
#include "workstation/runs/sweep/collected.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFiles[] = {"student.json", "student_weights.h", "run.json"};

/// Three files, one after the other.
TaskWork writing(const std::string& text, unsigned pause_us = 0) {
  return [=](const fs::path& at, std::FILE*) {
    for (const char* name : kFiles) {
      write_file(at / name, text);
      usleep(pause_us);
    }
  };
}
const TaskWork kFailing = [](const fs::path& at, std::FILE*) {
  write_file(at / "student.json", "half");
  fail("no space left");
};

class Task : public testing::Test {
 protected:
  /// In a process of its own, as an engine runs it.
  pid_t start(int task, unsigned pause_us) {
    const pid_t pid = fork();
    if (pid != 0) return pid;
    try {
      complete_task(folder_, task, writing(std::to_string(task), pause_us));
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  static int end_of(pid_t pid) {
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  void expect_whole(int task) {
    for (const char* name : kFiles) {
      EXPECT_EQ(text_of_file(folder_.result(task) / name), std::to_string(task));
    }
    EXPECT_FALSE(fs::exists(folder_.parts(task)));
    EXPECT_FALSE(fs::exists(folder_.log(task)));
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
};

TEST_F(Task, IsPublishedOnceAndThenLeftAlone) {
  EXPECT_TRUE(complete_task(folder_, 17, writing("17")));
  expect_whole(17);
  EXPECT_FALSE(complete_task(folder_, 17, kFailing));
  expect_whole(17);
}

TEST_F(Task, WhatFailedLeavesItsReasonAndIsRunAgain) {
  EXPECT_THROW(complete_task(folder_, 2, kFailing), UserError);
  EXPECT_FALSE(fs::exists(folder_.result(2)));
  EXPECT_THAT(text_of_file(folder_.log(2)), Names("no space left"));
  EXPECT_TRUE(complete_task(folder_, 2, writing("2")));
  expect_whole(2);
}

TEST_F(Task, OfTwoAtOnceTheSecondChangesNothing) {
  const TaskWork overtaken = [&](const fs::path& at, std::FILE* log) {
    complete_task(folder_, 1, writing("1"));
    EXPECT_FALSE(fs::exists(at)) << "the first cleared up";
    writing("another")(at, log);
  };
  EXPECT_NO_THROW(complete_task(folder_, 1, overtaken));
  expect_whole(1);
}

TEST_F(Task, HalfOfAnOutputIsMadeAgain) {
  write_file(folder_.result(3) / "student.json", "ha");
  EXPECT_FALSE(is_complete(folder_, 3));
  EXPECT_TRUE(complete_task(folder_, 3, writing("3")));
  expect_whole(3);
}

TEST_F(Task, WhatCannotBePublishedFailsAndIsRunAgain) {
  const fs::path in_the_way = folder_.result(1).parent_path();
  write_file(in_the_way, "a file where a folder must be");
  EXPECT_ANY_THROW(complete_task(folder_, 1, writing("1")));
  fs::remove(in_the_way);
  EXPECT_TRUE(complete_task(folder_, 1, writing("1")));
  expect_whole(1);
}

TEST_F(Task, AFileThatMayNotGrowIsAFailure) {
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit none{0, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &none);
  EXPECT_THROW(complete_task(folder_, 1, writing("1")), UserError);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_FALSE(is_complete(folder_, 1));
  EXPECT_TRUE(complete_task(folder_, 1, writing("1")));
  expect_whole(1);
}

TEST_F(Task, KilledAtAnyMomentAloneOrInPairsNothingIsHalf) {
  constexpr int kTasks = 12;
  Random random(1);
  for (int round = 0; round < 60; ++round) {
    const int task = 1 + static_cast<int>(random.index(kTasks));
    const pid_t first = start(task, 2'000);
    const pid_t second = start(task, 2'000);
    usleep(static_cast<unsigned>(12'000 * random.uniform()));
    kill(first, random.index(2) == 0 ? SIGKILL : SIGTERM);
    if (random.index(2) == 0) kill(second, SIGKILL);
    end_of(first);
    EXPECT_THAT(end_of(second), testing::AnyOf(0, 128 + SIGKILL));
    if (is_complete(folder_, task)) {
      for (const char* name : kFiles) EXPECT_TRUE(fs::exists(folder_.result(task) / name));
    }
  }
  for (int task = 1; task <= kTasks; ++task) {
    EXPECT_EQ(end_of(start(task, 0)), 0);
    for (const char* name : kFiles) {
      EXPECT_EQ(text_of_file(folder_.result(task) / name), std::to_string(task));
    }
  }
}

}  // namespace
}  // namespace bess
