// Attempts, their publication and their failures, with work that costs nothing; and what is left
// when programs are killed at any moment, two at once, or the disk is full.
#include "workstation/sweep/attempt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "shared/host/child_process.h"
#include "shared/host/command_line.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "workstation/base/random.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TaskWork writing(const std::string& text) {
  return [text](const fs::path& at) {
    write_file(at / "student.json", text);
    write_file(at / "run.json", "{}");
  };
}
const TaskWork kFailing = [](const fs::path& at) {
  write_file(at / "student.json", "half");
  fail("no space left");
};

class Attempt : public testing::Test {
 protected:
  /// Of a program that is there no more: a child that ended.
  static std::string name_of_the_dead() {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) {
      const std::string name = own_name();
      [[maybe_unused]] const auto written = write(ends[1], name.data(), name.size());
      _exit(0);
    }
    waitpid(pid, nullptr, 0);
    char name[512];
    const ssize_t size = read(ends[0], name, sizeof name);
    close(ends[0]);
    close(ends[1]);
    return {name, static_cast<std::size_t>(size)};
  }

  int at_work_on(int task) {
    int count = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder_.attempts(task), error)) {
      count += entry.path().extension() == kEnded ? 0 : 1;
    }
    return count;
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
};

TEST_F(Attempt, IsPublishedOnceAndThenLeftAlone) {
  EXPECT_EQ(attempt_task(folder_, 17, writing("a")), TaskEnd::kPublished);
  EXPECT_EQ(read_file(folder_.result(17) / "student.json"), "a");
  EXPECT_EQ(attempt_task(folder_, 17, writing("b")), TaskEnd::kAlreadyThere);
  EXPECT_EQ(read_file(folder_.result(17) / "student.json"), "a");
  EXPECT_FALSE(fs::exists(folder_.attempts(17)));
}

TEST_F(Attempt, ASecondCopyComparesWhatItMade) {
  const auto beside = [&](const std::string& first, const std::string& second) {
    return [&, first, second](const fs::path& at) {  // the other one is quicker
      write_file(folder_.result(1) / "student.json", first);
      write_file(folder_.result(1) / "run.json", "{}");
      write_file(folder_.result(1) / "times.json", "never the same");
      writing(second)(at);
    };
  };
  EXPECT_EQ(attempt_task(folder_, 1, beside("a", "a")), TaskEnd::kSame);
  EXPECT_FALSE(fs::exists(folder_.different()));
  fs::remove_all(folder_.result(1));
  EXPECT_EQ(attempt_task(folder_, 1, beside("a", "b")), TaskEnd::kDifferent);
  EXPECT_EQ(read_file(folder_.result(1) / "student.json"), "a") << "nothing is replaced";
  EXPECT_EQ(read_file(folder_.different() / ("000001." + own_name()) / "student.json"), "b");
  EXPECT_EQ(counts_of(folder_, task_states(folder_, 1)).different, 1);
}

TEST_F(Attempt, WhatFailedLeavesItsReasonAndNothingElse) {
  EXPECT_THROW(attempt_task(folder_, 2, kFailing), UserError);
  EXPECT_FALSE(fs::exists(folder_.result(2)));
  EXPECT_THAT(fs::exists(folder_.attempts(2)) ? marks_of_folder(folder_.attempts(2))
                                              : std::vector<std::string>{},
              IsEmpty());
  EXPECT_THAT(failures_of(folder_, 2), ElementsAre(HasSubstr("no space left")));
  EXPECT_EQ(attempt_task(folder_, 2, writing("a")), TaskEnd::kPublished);
}

TEST_F(Attempt, AfterThreeFailuresATaskIsLeftAlone) {
  for (const char* who : {"n1.0.1.1", "n2.0.1.1", "n3.0.1.1"}) {
    EXPECT_EQ(task_states(folder_, 4).at(3), TaskState::kMissing);
    write_file(folder_.failures(4) / who, "lightning\n");
  }
  EXPECT_EQ(task_states(folder_, 4).at(3), TaskState::kFailed);
  try {
    attempt_task(folder_, 4, writing("a"));
    FAIL() << "was tried a fourth time";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("task 4 failed 3 times, last: n3.0.1.1: lightning"));
  }
}

TEST_F(Attempt, WhoIsGoneIsCountedOnceAndItsFolderTakenOver) {
  const std::string dead = name_of_the_dead();
  ASSERT_TRUE(is_gone(dead)) << dead;
  EXPECT_FALSE(is_gone(own_name()));
  EXPECT_FALSE(is_gone("elsewhere.00000000.1.1")) << "nobody here knows";
  write_file(folder_.attempts(5) / dead / "teacher.bin", "learnt");
  EXPECT_EQ(attempt_task(folder_, 5,
                         [](const fs::path& at) {
                           EXPECT_EQ(read_file(at / "teacher.bin"), "learnt");
                           writing("a")(at);
                         }),
            TaskEnd::kPublished);
  EXPECT_THAT(failures_of(folder_, 5), ElementsAre(HasSubstr("was killed")));
}

TEST_F(Attempt, WhoWasEndedElsewhereDidNotFailAndItsFolderIsTakenOver) {
  write_file(folder_.attempts(5) / "elsewhere.00000000.1.1.ended" / "teacher.bin", "learnt");
  EXPECT_EQ(attempt_task(folder_, 5,
                         [](const fs::path& at) {
                           EXPECT_EQ(read_file(at / "teacher.bin"), "learnt");
                           writing("a")(at);
                         }),
            TaskEnd::kPublished);
  EXPECT_THAT(failures_of(folder_, 5), IsEmpty());
  EXPECT_FALSE(fs::exists(folder_.attempts(5)));
}

TEST_F(Attempt, TermAndCtrlCAreNoFailuresAndKillIsOne) {
  int failures = 0;
  for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
    ChildProcess one({BESS_SWEEP_WORKER, "task", folder_.path, "9", "5000"});
    while (at_work_on(9) == 0) usleep(1'000);
    one.signal(signal);
    one.read_all();
    one.wait();
    failures += signal == SIGKILL ? 1 : 0;
    EXPECT_EQ(task_states(folder_, 9).at(8), TaskState::kMissing);
    EXPECT_EQ(failures_of(folder_, 9).size(), failures) << signal;
  }
}

TEST_F(Attempt, WorkThatIsInterruptedSavesItselfAndDidNotFail) {
  const auto interrupted = [](const fs::path& at) {
    write_file(at / "teacher.bin", "half learnt");
    throw Interrupted{};
  };
  EXPECT_THROW(attempt_task(folder_, 1, interrupted), Interrupted);
  EXPECT_EQ(at_work_on(1), 0);
  EXPECT_EQ(attempt_task(folder_, 1,
                         [](const fs::path& at) {
                           EXPECT_EQ(read_file(at / "teacher.bin"), "half learnt");
                           writing("a")(at);
                         }),
            TaskEnd::kPublished);
  EXPECT_THAT(failures_of(folder_, 1), IsEmpty());
}

TEST_F(Attempt, WhatCannotBePublishedIsKeptUntilItCan) {
  const fs::path in_the_way = folder_.result(1).parent_path();
  write_file(in_the_way, "a file where the folder of a thousand results must be");
  EXPECT_ANY_THROW(attempt_task(folder_, 1, writing("a")));
  EXPECT_THAT(failures_of(folder_, 1), IsEmpty());
  fs::remove(in_the_way);
  const TaskWork already = [](const fs::path& at) {
    EXPECT_EQ(read_file(at / "student.json"), "a");
  };
  EXPECT_EQ(attempt_task(folder_, 1, already), TaskEnd::kPublished);
  EXPECT_THAT(failures_of(folder_, 1), IsEmpty());
}

TEST_F(Attempt, HalfOfAResultIsSetAsideAndMadeAgain) {
  write_file(folder_.result(3) / "student.json", "ha");
  EXPECT_EQ(task_states(folder_, 3).at(2), TaskState::kMissing);
  EXPECT_EQ(attempt_task(folder_, 3, writing("a")), TaskEnd::kPublished);
  EXPECT_EQ(read_file(folder_.result(3) / "student.json"), "a");
  EXPECT_EQ(read_file(folder_.different() / ("000003." + own_name()) / "student.json"), "ha");
}

TEST_F(Attempt, AnAttemptElsewhereIsLeftToItself) {
  const fs::path other = folder_.attempts(6) / "elsewhere.00000000.1.1";
  write_file(other / "teacher.bin", "learnt");
  EXPECT_EQ(attempt_task(folder_, 6, writing("a")), TaskEnd::kPublished);
  EXPECT_TRUE(fs::exists(other / "teacher.bin"));
  EXPECT_THAT(failures_of(folder_, 6), IsEmpty());
}

/// Published are all tasks, each whole and as it must be, and nothing else is left.
void expect_whole(const SweepFolder& folder, int count) {
  for (int task = 1; task <= count; ++task) {
    for (const char* name : {"student.json", "student_weights.h", "run.json"}) {
      EXPECT_EQ(text_of_file(folder.result(task) / name),
                std::string(name) + " of " + std::to_string(task) + "\n");
    }
  }
  EXPECT_EQ(counts_of(folder, task_states(folder, count)).different, 0);
}

/// Until all is published: what was killed is forgiven, and gone on with.
void finish(const SweepFolder& folder, int count) {
  for (int round = 0; round < 20; ++round) {
    fs::remove_all(folder.path / "failures");
    ChildProcess last({BESS_SWEEP_WORKER, "run", folder.path, std::to_string(count), "4", "0"});
    last.read_all();
    if (last.wait() == 0) return;
  }
  FAIL() << "never finished";
}

TEST(KilledSweep, TwoRunnersKilledAtAnyMomentLoseAndDoubleNothing) {
  constexpr int kTasks = 60;
  const TemporaryFolder root;
  const SweepFolder folder{root.file("sweep")};
  Random random(1);
  for (int round = 0; round < 25; ++round) {
    const auto runner = [&] {
      return ChildProcess(
          {BESS_SWEEP_WORKER, "run", folder.path, std::to_string(kTasks), "3", "2"});
    };
    ChildProcess first(runner());
    ChildProcess second(runner());
    usleep(static_cast<unsigned>(1'000 + 40'000 * random.uniform()));
    first.signal(random.index(2) == 0 ? SIGKILL : SIGTERM);
    usleep(static_cast<unsigned>(10'000 * random.uniform()));
    second.signal(random.index(2) == 0 ? SIGKILL : SIGINT);
    first.read_all();
    second.read_all();
  }
  finish(folder, kTasks);
  expect_whole(folder, kTasks);
}

TEST(KilledSweep, TasksKilledAtAnyMomentAreTriedAgain) {
  constexpr int kTasks = 12;
  const TemporaryFolder root;
  const SweepFolder folder{root.file("sweep")};
  Random random(2);
  for (int killed = 0; killed < 120; ++killed) {
    const std::string task = std::to_string(1 + random.index(kTasks));
    ChildProcess one({BESS_SWEEP_WORKER, "task", folder.path, task, "3"});
    usleep(static_cast<unsigned>(14'000 * random.uniform()));
    one.signal(SIGKILL);
    one.read_all();
    one.wait();
  }
  finish(folder, kTasks);
  expect_whole(folder, kTasks);
}

TEST(SweepByIndex, GnuParallelRunsTheTasks) {
  if (std::system("command -v parallel >/dev/null") != 0) {
    GTEST_SKIP() << "no parallel here; tools/setup --test installs it";
  }
  const TemporaryFolder root;
  const SweepFolder folder{root.file("sweep")};
  ChildProcess parallel({"/bin/sh", "-c",
                         std::string("seq 12 | parallel --will-cite -j 4 ") + BESS_SWEEP_WORKER +
                             " task " + folder.path.string() + " {} 1"});
  EXPECT_THAT(parallel.read_all(), testing::Not(HasSubstr("rror")));
  EXPECT_EQ(parallel.wait(), 0);
  expect_whole(folder, 12);
}

TEST(KilledSweep, AFileThatMayNotGrowIsAFailureWithItsReason) {
  const TemporaryFolder root;
  const SweepFolder folder{root.file("sweep")};
  const std::string worker = std::string("trap '' XFSZ; ulimit -f 0; exec ") + BESS_SWEEP_WORKER;
  ChildProcess full({"/bin/sh", "-c", worker + " task " + folder.path.string() + " 1 0"});
  EXPECT_THAT(full.read_all(), HasSubstr("writing failed"));
  EXPECT_EQ(full.wait(), 1);
  EXPECT_FALSE(fs::exists(folder.result(1)));
  finish(folder, 1);
  expect_whole(folder, 1);
}

}  // namespace
}  // namespace bess
