// bess-train sweep collect: tables of finished tasks, and list of open tasks.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/collected.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

struct CollectArguments {
  std::string folder;
  bool partial = false;
  bool json = false;
};

std::size_t count_of(const std::vector<CollectedTask>& tasks, TaskState state) {
  return static_cast<std::size_t>(std::ranges::count(tasks, state, &CollectedTask::state));
}

/// Lists tasks without output, with cause and the commands that run them.
void report_missing_tasks(const SweepFolder& folder, const std::vector<CollectedTask>& tasks) {
  constexpr int kShown = 20;
  std::vector<int> holes;
  int shown = 0;
  for (const CollectedTask& task : tasks) {
    if (task.state == TaskState::kProved || task.state == TaskState::kUnproved) continue;
    holes.push_back(task.task.number);
    if (task.said.empty() || ++shown > kShown) continue;
    fmt::print("  task {}{} {}\n", task.task.number,
               task.state == TaskState::kFailed ? "" : " started; last message:", task.said);
  }
  if (holes.empty()) return;
  fmt::print("{} without an output; to run them:\n{}\nor on Slurm:\n{}",
             counted(holes.size(), "task"),
             shell_line({"bess-train", "sweep", "run", folder.path.string(), "--again"}),
             sbatch_lines(folder, holes));
}

void collect_sweep(const CollectArguments& options) {
  const SweepFolder folder{options.folder};
  load_sweep_record(folder);
  const auto tasks = collect_tasks(folder, load_tasks(folder));
  const std::size_t proved = count_of(tasks, TaskState::kProved);
  const std::size_t unproved = count_of(tasks, TaskState::kUnproved);
  if (options.json) {
    Json json = answer("sweep_collect");
    json.set("sweep", options.folder);
    json.set("tasks", tasks.size());
    json.set("proved", proved);
    json.set("not_proved", unproved);
    json.set("failed", count_of(tasks, TaskState::kFailed));
    json.set("missing", count_of(tasks, TaskState::kMissing));
    fmt::print("{}\n", json.line());
  } else {
    fmt::print("{}: {}, {} proved, {} not proved\n", options.folder, counted(tasks.size(), "task"),
               proved, unproved);
    report_missing_tasks(folder, tasks);
  }
  if (proved + unproved < tasks.size() && !options.partial) {
    fail("{}: tasks are missing or failed: add --partial for tables of the others", options.folder);
  }
  const auto sites = collect_sites(folder, tasks, load_sites(folder));
  write_file(folder.path / "tasks.csv", tasks_csv(tasks));
  write_file(folder.path / "settings.csv", settings_csv(tasks));
  if (!sites.empty()) write_file(folder.path / "sites.csv", sites_csv(sites));
}

}  // namespace

void add_sweep_collect(ProgramCommand& sweep) {
  auto options = std::make_shared<CollectArguments>();
  ProgramCommand command = sweep.subcommand(
      "collect", "write tasks.csv, settings.csv and sites.csv from finished tasks");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.flag("--partial", options->partial, "accept missing or failed tasks");
  command.flag("--json", options->json, "one JSON object: number of tasks by state");
  command.footer("Example:\n  bess-train sweep collect sweeps/first --partial");
  command.runs([options] { collect_sweep(*options); });
}

}  // namespace bess
