// bess-train sweep plan: validation and numbering of all tasks before the first starts.
#include <fmt/core.h>

#include <memory>
#include <numeric>

#include "shared/host/text.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

struct PlanArguments {
  SweepRequest request;
  std::string out;
  bool dry_run = false;
};

void report_plan(const PlanArguments& options, const SweepPlan& plan) {
  const std::size_t added = plan.tasks.size() - plan.known;
  fmt::print("{}: {}, {} new{}\n", options.out, counted(plan.tasks.size(), "task"), added,
             options.dry_run ? " (nothing was written)" : "");
  if (!plan.sites.empty()) {
    fmt::print("{} share {} per seed and setting\n", counted(plan.sites.size(), "site"),
               counted(plan.classes, "student"));
  }
  fmt::print("  first: {}\n  last:  {}\n", settings_shown(plan.tasks.front().settings),
             settings_shown(plan.tasks.back().settings));
  if (options.dry_run) return;
  std::vector<int> numbers(plan.tasks.size());
  std::iota(numbers.begin(), numbers.end(), 1);
  fmt::print("here:\n{}\non Slurm:\n{}", shell_line(parallel_command(plan.folder)),
             sbatch_lines(plan.folder, numbers));
}

void plan_now(PlanArguments& options) {
  const SweepFolder folder{options.out};
  const SweepPlan planned = plan_sweep(options.request, folder);
  if (!options.dry_run) write_plan(planned, options.request);
  report_plan(options, planned);
}

}  // namespace

void add_sweep_plan(ProgramCommand& sweep) {
  auto options = std::make_shared<PlanArguments>();
  SweepRequest& request = options->request;
  ProgramCommand command = sweep.subcommand("plan", "create and validate the tasks; no training");
  command.option("plan", request.plan, "TOML file: [grid], [[list]]").value_name("FILE");
  command.option("--prices", request.prices, "minute file; the sweep keeps a copy")
      .value_name("FILE")
      .required();
  request.price_input.add(command);
  command.option("--out", options->out, "folder of the sweep").value_name("DIR").required();
  command.option("--set", request.sets, "grid axis: section.key=VALUE[,VALUE]")
      .value_name("KEY=VALUES");
  command.option("--seeds", request.seeds, "seeds per setting (1 to N)")
      .range(1, 10'000)
      .with_default();
  command.option("--folds", request.folds, "one task per month, trained on the 120 days before")
      .one_of({"monthly"});
  command
      .option("--sites", request.sites,
              "CSV of fleet members; those with equal settings share a student")
      .value_name("FILE");
  command
      .option("--c-rate-step", request.c_rate_step_percent,
              "step of the C-rate, %; fleet members within one step share a student (default 0)")
      .range(0.0, 20.0)
      .needs("--sites");
  request.rules.add(command, "rule files of all tasks");
  command
      .option("--config", request.config,
              "TOML file of all tasks; 'bess-train config' prints all keys")
      .value_name("FILE");
  command.flag("--full", request.full, "complete runs with plain student, figures and page");
  command.flag("--dry-run", options->dry_run, "print the plan without writing");
  command.footer(
      "A repeated plan appends new tasks; existing tasks keep their number.\n"
      "Examples:\n"
      "  bess-train sweep plan --prices market.csv.gz --out sweeps/first --set "
      "distil.fidelity=1,2 --seeds 6\n"
      "  bess-train sweep plan plan.toml --prices market.csv.gz --out sweeps/second --dry-run");
  command.runs([options] { plan_now(*options); });
}

}  // namespace bess
