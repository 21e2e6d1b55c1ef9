// The commands by which engines run a sweep.
#include "workstation/runs/sweep/sweep_plan.h"

#include <gmock/gmock.h>

#include <numeric>

namespace bess {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Engines, ParallelRunsEachLineOfTheTasksUnlessItsJoblogHasIt) {
  const SweepFolder folder{"/a sweep"};
  EXPECT_THAT(
      shell_line(parallel_command(folder, 4)),
      AllOf(StartsWith("parallel --joblog '/a sweep/joblog' --resume-failed --colsep '\\t' "),
            HasSubstr("--jobs 4"), EndsWith(" :::: '/a sweep/tasks.tsv'")));
  const auto words = parallel_command(folder);
  EXPECT_THAT(words.at(words.size() - 3), EndsWith(" sweep task '/a sweep' {1}"))
      << "parallel's own shell parses it again";
}

TEST(Engines, AnArrayIsAThousandTasks) {
  const SweepFolder folder{"/sweep"};
  EXPECT_EQ(sbatch_lines(folder, {1, 2, 3, 7, 9, 10}),
            "sbatch --array=1-3,7,9-10 /sweep/array.sbatch\n");
  std::vector<int> tasks(2'001);
  std::iota(tasks.begin(), tasks.end(), 1);
  EXPECT_EQ(sbatch_lines(folder, tasks),
            "sbatch --array=1-1000 /sweep/array.sbatch\n"
            "sbatch --array=1-1000 /sweep/array.sbatch 1000\n"
            "sbatch --array=1 /sweep/array.sbatch 2000\n");
  EXPECT_EQ(sbatch_lines(folder, {}), "");
  EXPECT_THAT(
      array_script(folder),
      AllOf(StartsWith("#!/bin/sh\n"), HasSubstr("#SBATCH --output=\"/sweep/log/slurm.txt\""),
            HasSubstr(" sweep task /sweep $((SLURM_ARRAY_TASK_ID + ${1:-0}))\n")));
}

}  // namespace
}  // namespace bess
