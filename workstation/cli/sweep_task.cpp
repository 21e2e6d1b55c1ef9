// bess-train sweep task: one task by its number, for any engine that can count.
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
             is_new ? "" : ", complete already", folder.result(options.number).string());
}

}  // namespace

void add_sweep_task(ProgramCommand& sweep) {
  auto options = std::make_shared<TaskArguments>();
  ProgramCommand command =
      sweep.subcommand("task", "One task by its number, as an engine calls it");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.option("number", options->number, "From 1").range(1, 999'999).required();
  command.footer(
      "May be called for any task, at any time, on any machine, as often as you like: an output "
      "that is complete is left alone.\n"
      "Example:\n  bess-train sweep task sweeps/first 17");
  command.runs([options] { run_now(*options); });
}

}  // namespace bess
