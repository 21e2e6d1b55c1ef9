// bess-train sweep plan: every task, validated and numbered, before the first begins.
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/chain/folder_lock.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {
namespace {

struct PlanArguments {
  SweepRequest request;
  std::optional<int> seeds;
  std::string out;
  bool dry_run = false;
  bool json = false;
};

/// "12 minutes", "3.4 hours".
std::string core_time(double seconds) {
  return seconds < 3600 ? fmt::format("{:.0f} minutes", seconds / 60)
                        : fmt::format("{:.1f} hours", seconds / 3600);
}

void tell_plan(const PlanArguments& options, const SweepPlan& plan) {
  const SweepEstimate all = estimate_of(plan);
  const std::size_t added = plan.tasks.size() - plan.known;
  if (options.json) {
    Json json = answer("sweep_plan");
    json.set("sweep", options.out);
    json.set("tasks", plan.tasks.size());
    json.set("tasks_new", added);
    json.set("sites", plan.sites.size());
    json.set("students", plan.classes);
    json.set("core_hours_estimate", Decimals{all.seconds / 3600, 3});
    json.set("megabytes_estimate", Decimals{all.bytes / 1e6, 1});
    json.set("written", !options.dry_run);
    fmt::print("{}\n", json.line());
    return;
  }
  fmt::print("{}: {}, {} new{}\n", options.out, counted(plan.tasks.size(), "task"), added,
             options.dry_run ? " (nothing was written)" : "");
  if (!plan.sites.empty()) {
    fmt::print("{} share {} a seed and setting\n", counted(plan.sites.size(), "site"),
               counted(plan.classes, "student"));
  }
  if (added == 0) return;
  fmt::print("  first: {}\n  last:  {}\n", settings_shown(plan.tasks[plan.known].settings),
             settings_shown(plan.tasks.back().settings));
  fmt::print("what is new takes about {} of one core and {:.1f} MB\n", core_time(all.seconds),
             all.bytes / 1e6);
}

void plan_now(PlanArguments& options) {
  options.request.seeds = options.seeds.value_or(0);
  const SweepFolder folder{options.out};
  std::optional<FolderLock> lock;
  if (std::filesystem::is_directory(folder.path)) lock.emplace(folder.path);
  const SweepPlan planned = plan_sweep(options.request, folder);
  if (!options.dry_run) write_plan(planned, options.request);
  tell_plan(options, planned);
}

}  // namespace

void add_sweep_plan(ProgramCommand& sweep) {
  auto options = std::make_shared<PlanArguments>();
  SweepRequest& request = options->request;
  ProgramCommand command =
      sweep.subcommand("plan", "Number and validate every task; nothing is learnt yet");
  command.option("plan", request.plan, "TOML file: [sweep], [grid], [[list]], [random]");
  command.option("--prices", request.prices, "Minute file; the sweep keeps a copy").required();
  request.price_input.add(command);
  command.option("--out", options->out, "Folder of the sweep").required();
  command.option("--set", request.sets, "An axis of the grid: section.key=VALUE[,VALUE]");
  command.option("--seeds", options->seeds, "Seeds 1 to this of every setting (default 1)")
      .range(1, 10'000);
  command
      .option("--folds", request.folds,
              "Each month learnt from the 120 days before it, a task each")
      .one_of({"monthly"});
  command.option("--sites", request.sites, "CSV of sites; those that learn alike share a student");
  command.option("--config", request.config,
                 "TOML file that all tasks have in common; 'bess-train config' prints all keys");
  command.flag("--full", request.full, "Whole runs with plain student, figures and page");
  command.flag("--dry-run", options->dry_run, "Tell what would be planned, and write nothing");
  command.flag("--json", options->json, "One JSON object");
  command.footer(
      "Planned again with more, what is new is appended and every task keeps its number.\n"
      "Examples:\n"
      "  bess-train sweep plan --prices market.csv.gz --out sweeps/first --set "
      "distil.fidelity=1,2 --seeds 6\n"
      "  bess-train sweep plan plan.toml --prices market.csv.gz --out sweeps/second --dry-run\n"
      "  bess-train sweep plan --prices market.csv.gz --sites sites.csv --out sweeps/fleet\n"
      "A plan:\n"
      "  [sweep]\n"
      "  seeds = 3                              # or a list; also config, rules, sites, folds, "
      "full\n"
      "  [grid]                                 # every combination\n"
      "  \"distil.fidelity\" = [1, 2]\n"
      "  [[list]]                               # points, each combined with the grid\n"
      "  \"costs.import_percent\" = 2\n"
      "  [random]                               # draws, the first of which stay when count grows\n"
      "  count = 10\n"
      "  seed = 1\n"
      "  \"train.learning_rate\" = { low = 1e-4, high = 1e-2, log = true }");
  command.runs([options] { plan_now(*options); });
}

}  // namespace bess
