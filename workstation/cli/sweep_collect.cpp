// bess-train sweep collect: what all tasks came to, as tables and a page.
#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/sweep_page.h"

namespace bess {
namespace {

struct CollectArguments {
  std::string folder;
  bool partial = false;
  std::vector<std::string> map;
};

void require_whole(const SweepFolder& folder, const std::vector<TaskState>& states) {
  std::vector<int> holes;
  for (std::size_t t = 0; t < states.size(); ++t) {
    const bool is_done = states[t] == TaskState::kProved || states[t] == TaskState::kUnproved;
    if (!is_done) holes.push_back(static_cast<int>(t) + 1);
  }
  if (holes.empty()) return;
  std::string names = ranges_text(holes);
  if (names.size() > 80) names = names.substr(0, names.rfind(',', 80)) + ",...";
  fail(
      "{}: {} of {} tasks have no result: {}; 'bess-train sweep run {}' goes on, --partial "
      "collects what there is",
      folder.path.string(), holes.size(), states.size(), names, folder.path.string());
}

void collect_sweep(const CollectArguments& options) {
  if (options.map.size() > 2) fail("--map: give one or two settings");
  const SweepFolder folder{options.folder};
  const SweepRecord record = load_sweep_record(folder);
  const std::vector<SweepTask> planned = load_tasks(folder);
  const auto states = task_states(folder, static_cast<int>(planned.size()));
  if (!options.partial) require_whole(folder, states);
  const std::vector<CollectedTask> tasks = collect_tasks(folder, planned, states);
  const std::vector<CollectedSite> sites = collect_sites(folder, tasks, load_sites(folder));
  write_file(folder.path / "tasks.csv", tasks_csv(tasks));
  if (!sites.empty()) write_file(folder.path / "sites.csv", sites_csv(sites));
  write_file(folder.path / "sweep.html", sweep_page(record, tasks, sites, options.map));
  fmt::print("{}: tasks.csv{} and sweep.html of {} tasks\n", options.folder,
             sites.empty() ? "" : ", sites.csv", tasks.size());
}

}  // namespace

void add_sweep_collect(ProgramCommand& sweep) {
  auto options = std::make_shared<CollectArguments>();
  ProgramCommand command = sweep.subcommand(
      "collect", "What all tasks came to: tasks.csv, sites.csv and sweep.html, in the folder");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.flag("--partial", options->partial, "Also when tasks are missing or failed");
  command.option("--map", options->map, "The one or two settings of the heat map");
  command.footer(
      "Examples:\n"
      "  bess-train sweep collect sweeps/first\n"
      "  bess-train sweep collect sweeps/first --partial --map distil.fidelity train.steps");
  command.runs([options] { collect_sweep(*options); });
}

}  // namespace bess
