// bess-train sweep task: one task by its number, for any engine that can count.
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/learn_task.h"
#include "workstation/sweep/slurm.h"

namespace bess {
namespace {

struct TaskArguments {
  std::optional<int> number;
  std::string of;
  std::optional<int> submission;
  std::optional<int> element;
};

void do_task(const SweepFolder& folder, int task) {
  end_when_interrupted("what others made is kept; the task is begun anew, where it was");
  LearningTasks learning(folder);
  say_end(folder, task, attempt_task(folder, task, learning.work(task)));
}

/// Each a process of its own: one that dies takes no other along.
void do_element(const SweepFolder& folder, int submission, int element) {
  const std::vector<int> tasks = tasks_of_element(folder, submission, element);
  const RunHereResult result = learn_here(folder, tasks, 1);
  if (result.failed > 0) fail("{} of {} tasks failed", result.failed, tasks.size());
}

}  // namespace

void add_sweep_task(ProgramCommand& sweep) {
  auto options = std::make_shared<TaskArguments>();
  ProgramCommand command =
      sweep.subcommand("task", "One task by its number: for engines that are not Slurm");
  command.option("number", options->number, "From 1").range(1, 999'999);
  command.option("--of", options->of, "Folder of the sweep").required();
  command.option("--submission", options->submission, "Of what was sent to Slurm, with --element")
      .excludes("number");
  command.option("--element", options->element, "Of the array: the tasks in its line")
      .needs("--submission");
  command.footer(
      "May be called for any task, at any time, anywhere, as often as you like: what is there is "
      "left alone, and a second copy that runs beside the first compares what it made.\n"
      "Examples:\n"
      "  bess-train sweep task 17 --of sweeps/first\n"
      "  seq 12 | parallel -j 4 bess-train sweep task {} --of sweeps/first");
  command.runs([options] {
    const SweepFolder folder{options->of};
    if (options->number) return do_task(folder, *options->number);
    if (!options->submission || !options->element) {
      fail("which task? give its number, or --submission and --element");
    }
    do_element(folder, *options->submission, *options->element);
  });
}

}  // namespace bess
