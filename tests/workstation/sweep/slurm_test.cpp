// The client of Slurm against a Slurm that is played: what it asks, what it sends, and what it does
// not send again. Against the real one: tests/workstation/sweep/slurm_on_loopback.sh.
#include "workstation/sweep/slurm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kId = "0123abcd";

TEST(Ranges, ThereAndBack) {
  EXPECT_EQ(ranges_text({1, 2, 3, 7, 9, 10}), "1-3,7,9-10");
  EXPECT_THAT(parse_ranges("1-3,7,9-10", "here"), ElementsAre(1, 2, 3, 7, 9, 10));
  EXPECT_EQ(ranges_text({}), "");
  for (const char* bad : {"a", "0", "3-1", "1-", "1;2", "-4", "1-99999999999"}) {
    EXPECT_THROW(parse_ranges(bad, "here"), UserError) << bad;
  }
}

TEST(Chunks, AsManyTasksAnElementAsTheLimitsNeed) {
  std::vector<int> tasks;
  for (int task = 1; task <= 10'000; ++task) tasks.push_back(task);
  const Chunks chunks = chunked(tasks, 0, 1'000);
  EXPECT_EQ(chunks.size(), 1'000);
  EXPECT_EQ(chunks.back().size(), 10);
  EXPECT_EQ(chunks.back().back(), 10'000);
  EXPECT_EQ(chunked({1, 2, 3}, 0, 1'000).size(), 3);
  EXPECT_THAT(chunked({1, 2, 3, 4, 5}, 2, 10),
              ElementsAre(ElementsAre(1, 2), ElementsAre(3, 4), ElementsAre(5)));
  EXPECT_EQ(chunked({1, 2, 3, 4, 5}, 1, 2).size(), 2) << "the rest is sent later";
}

TEST(Chunks, AnElementIsAMinuteOfTasks) {
  EXPECT_EQ(elements_wanted(10'000, 0), 1'000) << "unknown";
  EXPECT_EQ(elements_wanted(10'000, 45), 1'000);
  EXPECT_EQ(elements_wanted(400, 15), 100) << "four tasks each";
  EXPECT_EQ(elements_wanted(10'000, 0.01), 2);
  EXPECT_EQ(elements_wanted(3, 0.01), 1);
}

TEST(Limits, AsScontrolShowsThem) {
  const SlurmLimits limits =
      parse_limits("MaxArraySize            = 501\nMaxJobCount             = 2000\n");
  EXPECT_EQ(limits.array_max, 501);
  EXPECT_EQ(limits.jobs_max, 2'000);
  EXPECT_EQ(parse_limits("").array_max, 1'001) << "Slurm's own default";
}

TEST(Queue, OnlyThisSweepsElements) {
  const auto waiting =
      parse_queue("bess-0123abcd-2 7\nother 1\nbess-99999999-2 3\nbess-0123abcd-1 4\n", kId);
  ASSERT_EQ(waiting.size(), 2);
  EXPECT_EQ(waiting[0].submission, 1);
  EXPECT_EQ(waiting[0].element, 4);
  EXPECT_EQ(waiting[1].element, 7);
}

/// sbatch, squeue and scontrol before all others in PATH; what is in queue.txt waits.
class PlayedSlurm : public testing::Test {
 protected:
  PlayedSlurm() : path_before_(std::getenv("PATH")) {
    play("scontrol", "echo 'MaxArraySize = 11'; echo 'MaxJobCount = 100'");
    play("squeue", "cat '" + root_.file("queue.txt") + "'");
    play("sbatch", "echo \"$@\" >>'" + root_.file("sent.txt") + "'; echo 4711");
    (void)root_.write("queue.txt", "");
    setenv("PATH", (root_.file("bin") + ":" + path_before_).c_str(), 1);
  }
  ~PlayedSlurm() override { setenv("PATH", path_before_.c_str(), 1); }

  void play(const std::string& name, const std::string& script) {
    const fs::path path = fs::path(root_.file("bin")) / name;
    write_file(path, "#!/bin/sh\n" + script + "\n");
    fs::permissions(path, fs::perms::owner_all);
  }

  TemporaryFolder root_;
  SweepFolder folder_{root_.file("sweep")};
  std::string path_before_;
};

TEST_F(PlayedSlurm, OneArrayWithAChunkAnElement) {
  std::vector<int> missing;
  for (int task = 1; task <= 25; ++task) missing.push_back(task);
  const Submission sent =
      submit(folder_, kId, missing, {.at_once = 4, .options = {"--partition=main"}});
  EXPECT_EQ(sent.tasks, 25);
  EXPECT_EQ(sent.elements, 9) << "at most 10, 3 each";
  EXPECT_EQ(sent.job, "4711");
  EXPECT_THAT(text_of_file(root_.file("sent.txt")),
              AllOf(HasSubstr("--job-name=bess-0123abcd-1"), HasSubstr("--array=1-9%4"),
                    HasSubstr("--partition=main")));
  EXPECT_THAT(tasks_of_element(folder_, 1, 2), ElementsAre(4, 5, 6));
  EXPECT_THAT(tasks_of_element(folder_, 1, 9), ElementsAre(25));
  EXPECT_THROW(tasks_of_element(folder_, 1, 10), UserError);
  EXPECT_THAT(read_file(folder_.submissions() / "1.sh"),
              HasSubstr("--submission 1 --element \"$SLURM_ARRAY_TASK_ID\""));
}

TEST_F(PlayedSlurm, WhatWaitsOrRunsIsNotSentAgain) {
  submit(folder_, kId, {1, 2, 3, 4}, {.at_once = 4, .chunk = 2});
  (void)root_.write("queue.txt", "bess-0123abcd-1 2\n");  // tasks 3 and 4; element 1 is gone
  const Submission again = submit(folder_, kId, {1, 3, 4}, {.at_once = 4});
  EXPECT_EQ(again.tasks, 1);
  EXPECT_EQ(again.waiting, 2);
  EXPECT_THAT(tasks_of_element(folder_, 2, 1), ElementsAre(1));
  EXPECT_THAT(waiting_tasks(folder_, kId), ElementsAre(3, 4));
  (void)root_.write("queue.txt", "bess-0123abcd-1 2\nbess-0123abcd-2 1\n");
  EXPECT_EQ(submit(folder_, kId, {1, 3, 4}, {.at_once = 4}).tasks, 0);
  EXPECT_FALSE(fs::exists(folder_.submissions() / "3.tsv"));
}

TEST_F(PlayedSlurm, AJobWhoseAnswerIsLostWasSent) {
  const std::string queue = root_.file("queue.txt");
  play("sbatch", "echo 'bess-0123abcd-1 1' >'" + queue + "'; echo 'connection lost' >&2; exit 1");
  const Submission sent = submit(folder_, kId, {1, 2}, {.task_s = 10});
  EXPECT_EQ(sent.tasks, 2);
  EXPECT_EQ(sent.chunk, 2);
  EXPECT_EQ(sent.job, "bess-0123abcd-1");
  EXPECT_EQ(submit(folder_, kId, {1, 2}, {}).tasks, 0);
}

TEST_F(PlayedSlurm, NothingMissingAsksNobody) {
  play("squeue", "exit 1");
  EXPECT_EQ(submit(folder_, kId, {}, {}).tasks, 0);
}

TEST_F(PlayedSlurm, AFullQueueAndARefusalAreTold) {
  std::string full;
  for (int job = 0; job < 99; ++job) full += "other N/A\n";
  (void)root_.write("queue.txt", full);
  EXPECT_THROW(submit(folder_, kId, {1}, {}), UserError);
  (void)root_.write("queue.txt", "");
  play("sbatch", "echo 'sbatch: error: invalid partition specified: none' >&2; exit 1");
  try {
    submit(folder_, kId, {1}, {});
    FAIL() << "was taken for sent";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("invalid partition"), HasSubstr("nothing was sent")));
  }
}

TEST_F(PlayedSlurm, WithoutSlurmTheMendIsNamed) {
  setenv("PATH", root_.file("nothing").c_str(), 1);
  try {
    submit(folder_, kId, {1}, {});
    FAIL() << "there is no Slurm";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is Slurm here"));
  }
  EXPECT_THAT(waiting_tasks(folder_, kId), IsEmpty());
}

}  // namespace
}  // namespace bess
