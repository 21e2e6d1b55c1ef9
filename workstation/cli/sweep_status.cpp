// bess-train sweep status: what is done, what failed and why, what waits.
#include <fmt/core.h>

#include <memory>

#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/slurm.h"
#include "workstation/sweep/sweep_plan.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

struct StatusArguments {
  std::string folder;
  bool json = false;
};

void list_failed(const SweepFolder& folder, const std::vector<TaskState>& states) {
  constexpr int kShown = 10;
  int shown = 0;
  for (std::size_t t = 0; t < states.size(); ++t) {
    if (states[t] != TaskState::kFailed || ++shown > kShown) continue;
    const int task = static_cast<int>(t) + 1;
    fmt::print("  task {}: {}\n", task, failures_of(folder, task).back());
  }
  if (shown > kShown) fmt::print("  and {} more\n", shown - kShown);
}

void tell_status(const StatusArguments& options) {
  const SweepFolder folder{options.folder};
  const SweepRecord record = load_sweep_record(folder);
  const auto states = task_states(folder, static_cast<int>(load_tasks(folder).size()));
  const SweepCounts c = counts_of(folder, states);
  const std::size_t waiting = waiting_tasks(folder, record.id).size();
  if (options.json) {
    Json json = answer("sweep_status");
    json.set("sweep", options.folder);
    json.set("tasks", c.planned);
    json.set("proved", c.proved);
    json.set("not_proved", c.unproved);
    json.set("failed", c.failed);
    json.set("missing", c.missing);
    json.set("attempts", c.attempts);
    json.set("different", c.different);
    json.set("on_slurm", waiting);
    fmt::print("{}\n", json.line());
    return;
  }
  fmt::print("{}: {} tasks: {} proved, {} not proved, {} failed, {} missing\n", options.folder,
             c.planned, c.proved, c.unproved, c.failed, c.missing);
  if (c.attempts > 0) fmt::print("{} attempts are at work, or were left behind\n", c.attempts);
  if (waiting > 0) fmt::print("{} tasks wait or run on Slurm\n", waiting);
  if (c.different > 0) {
    fmt::print("{} second copies came to something else: {}\n", c.different,
               folder.different().string());
  }
  list_failed(folder, states);
}

}  // namespace

void add_sweep_status(ProgramCommand& sweep) {
  auto options = std::make_shared<StatusArguments>();
  ProgramCommand command =
      sweep.subcommand("status", "What is done, what failed and why, what is missing");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.flag("--json", options->json, "One JSON object");
  command.footer("Example:\n  bess-train sweep status sweeps/first");
  command.runs([options] { tell_status(*options); });
}

}  // namespace bess
