// bess-train sweep task: one task by its number, for schedulers.
#include <fmt/core.h>

#include <memory>

#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/collected.h"

namespace bess {
namespace {

struct TaskArguments {
  std::string folder;
  int number = 0;
};

void run_now(const TaskArguments& options) {
  const SweepFolder folder{options.folder};
  const bool is_new = run_task(folder, options.number);
  fmt::print("task {}: {}{}: {}\n", options.number,
             is_proved(folder, options.number) ? "proved" : "not proved",
             is_new ? "" : ", already complete", folder.result(options.number).string());
}

}  // namespace

void add_sweep_task(ProgramCommand& sweep) {
  auto options = std::make_shared<TaskArguments>();
  ProgramCommand command = sweep.subcommand("task", "run one task by number (for schedulers)");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.option("number", options->number, "task number, from 1").range(1, 999'999).required();
  command.footer(
      "Can be repeated for any task on any machine: complete outputs are kept.\n"
      "Example:\n  bess-train sweep task sweeps/first 17");
  command.runs([options] { run_now(*options); });
}

}  // namespace bess
