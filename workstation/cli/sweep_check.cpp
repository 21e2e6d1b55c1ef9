// bess-train sweep check: some tasks once more on this machine, compared byte by byte.
#include <fmt/core.h>

#include <memory>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/check_share.h"
#include "workstation/sweep/learn_task.h"
#include "workstation/sweep/sweep_plan.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

struct CheckArguments {
  std::string folder;
  std::string share = "1%";
  std::uint64_t seed = 1;
};

std::vector<int> done_tasks(const SweepFolder& folder) {
  const auto states = task_states(folder, static_cast<int>(load_tasks(folder).size()));
  std::vector<int> done;
  for (std::size_t t = 0; t < states.size(); ++t) {
    if (states[t] == TaskState::kProved || states[t] == TaskState::kUnproved) {
      done.push_back(static_cast<int>(t) + 1);
    }
  }
  if (done.empty()) fail("{}: no task is done yet", folder.path.string());
  return done;
}

void check_sweep(const CheckArguments& options) {
  const SweepFolder folder{options.folder};
  const auto drawn =
      drawn_share(done_tasks(folder), std::strtod(options.share.c_str(), nullptr), options.seed);
  end_when_interrupted();
  std::size_t differ = 0;
  for (const int task : drawn) {
    const auto other = check_task(folder, task, learning_work(folder, task));
    differ += other.empty() ? 0 : 1;
    fmt::print("task {}: {}\n", task, other.empty() ? "the same" : "differs");
    for (const std::string& line : other) fmt::print("  {}\n", line);
    std::fflush(stdout);
  }
  if (differ > 0) {
    fail("{} of {} differ: they were made by another kind of machine, or were changed since",
         differ, counted(drawn.size(), "task"));
  }
  fmt::print("{}: {} made again, all the same\n", options.folder, counted(drawn.size(), "task"));
}

}  // namespace

void add_sweep_check(ProgramCommand& sweep) {
  auto options = std::make_shared<CheckArguments>();
  ProgramCommand command = sweep.subcommand(
      "check", "Some tasks once more on this machine: every file must come out the same");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.option("--share", options->share, "Of the tasks that are done; at least one")
      .with_default()
      .check([](const std::string& text) -> std::string {
        char* end = nullptr;
        const double share = std::strtod(text.c_str(), &end);
        const std::string rest = end;
        return share > 0 && share <= 100 && (rest.empty() || rest == "%")
                   ? ""
                   : "use a share above 0% and up to 100%";
      });
  command.option("--seed", options->seed, "Of the draw").with_default();
  command.footer("Example:\n  bess-train sweep check sweeps/first --share 1%");
  command.runs([options] { check_sweep(*options); });
}

}  // namespace bess
