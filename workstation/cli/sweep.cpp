// bess-train sweep: many runs, local or on a cluster.
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/collected.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

// bess-train sweep plan: validation and numbering of all tasks before the first starts.

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

void add_sweep_plan(ProgramCommand& sweep) {
  auto options = std::make_shared<PlanArguments>();
  SweepRequest& request = options->request;
  ProgramCommand command = sweep.subcommand("plan", "create and validate the tasks; no training");
  command.option("plan", request.plan, "TOML file: [grid], [[list]]").value_name("FILE");
  command.option("--prices", request.prices, "minute file; the sweep keeps a copy").required();
  request.price_input.add(command);
  command.option("--out", options->out, "folder of the sweep").value_name("DIR").required();
  command.option("--set", request.sets, "grid axis: section.key=VALUE[,VALUE]")
      .value_name("KEY=VALUES");
  command.option("--seeds", request.seeds, "seeds per setting (1 to N)")
      .range(1, 10'000)
      .with_default();
  command.option("--folds", request.folds, "one task per month, trained on the 120 days before")
      .one_of({"monthly"});
  command.option("--sites", request.sites,
                 "CSV of fleet members; those with equal settings share a student");
  command
      .option("--c-rate-step", request.c_rate_step_percent,
              "step of the C-rate, %; fleet members within one step share a student (default 0)")
      .range(0.0, 20.0)
      .needs("--sites");
  request.rules.add(command, "rule files of all tasks");
  command.option("--config", request.config,
                 "TOML file of all tasks; 'bess-train config' prints all keys");
  command.flag("--full", request.full, "complete runs with plain student, figures and page");
  command.flag("--dry-run", options->dry_run, "print the plan without writing");
  command.footer(
      "A repeated plan appends new tasks; existing tasks keep their number.\n"
      "Examples:\n"
      "  bess-train sweep plan --prices market.csv.gz --out sweeps/first --set "
      "distil.fidelity=1,2 --seeds 6\n"
      "  bess-train sweep plan plan.toml --prices market.csv.gz --out sweeps/second --dry-run");
  command.runs([options] {
    const SweepPlan planned = plan_sweep(options->request, {options->out});
    if (!options->dry_run) write_plan(planned, options->request);
    report_plan(*options, planned);
  });
}

// bess-train sweep run: tasks on this machine, by GNU parallel, which replaces this process.

struct SweepRunArguments {
  std::string folder;
  std::optional<int> jobs;
  bool again = false;
};

[[noreturn]] void become_parallel(const SweepRunArguments& options) {
  const SweepFolder folder{options.folder};
  load_own_sweep(folder);
  if (options.again) std::filesystem::remove(folder.joblog());
  // The exit code of parallel is the number of failed tasks, which would read as another error.
  const std::string line =
      "command -v parallel >/dev/null || "
      "{ echo \"bess-train: install GNU parallel (Debian package 'parallel')\" >&2; exit 1; }; " +
      shell_line(parallel_command(folder, options.jobs)) + " || exit 1";
  execlp("sh", "sh", "-c", line.c_str(), nullptr);
  fail("cannot run sh: {}", std::strerror(errno));
}

void add_sweep_run(ProgramCommand& sweep) {
  auto options = std::make_shared<SweepRunArguments>();
  ProgramCommand command =
      sweep.subcommand("run", "run open tasks on this machine with GNU parallel");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.option("--jobs", options->jobs, "parallel tasks, one core each (default: all cores)")
      .range(1, 1024);
  command.flag("--again", options->again, "check every task, also those marked done");
  command.footer(
      "Repeat the command to continue and to retry failed tasks.\n"
      "Example:\n  bess-train sweep run sweeps/first --jobs 4");
  command.runs([options] { become_parallel(*options); });
}

// bess-train sweep task: one task by its number, for schedulers.

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

// bess-train sweep collect: tables of finished tasks, and list of open tasks.

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
    const Json json = answer("sweep_collect", {{"sweep", options.folder},
                                               {"tasks", tasks.size()},
                                               {"proved", proved},
                                               {"not_proved", unproved},
                                               {"failed", count_of(tasks, TaskState::kFailed)},
                                               {"missing", count_of(tasks, TaskState::kMissing)}});
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

// bess-train sweep packages: Debian packages by class of fleet members, and an Ansible inventory.

struct PackagesArguments {
  std::string folder, out, source = ".";
  std::vector<std::string> architectures{"arm64"};
  bool partial = false;
};

void package_sweep(const PackagesArguments& options) {
  if (!fs::exists(fs::path(options.source) / "tools/package"))
    fail(
        "{}: no tools/package here: packages are compiled from a source checkout; name it with "
        "--source DIR",
        options.source);
  const PackageRequest request{fs::canonical(options.source), fs::absolute(options.out),
                               options.architectures};
  const SweepFolder folder{options.folder};
  const auto tasks = collect_tasks(folder, load_tasks(folder));
  const std::vector<Site> sites = load_sites(folder);
  if (sites.empty())
    fail("{}: planned without --sites, so it has no classes; plan it with --sites", options.folder);
  auto classes = classes_to_package(tasks, collect_sites(folder, tasks, sites), options.partial);
  for (PackagedClass& one : classes) {
    const bool is_new = package_class(folder, request, one);
    fmt::print("class {}: student {}, {}: {}{}\n", one.name, one.student,
               counted(one.sites.size(), "site"), one.version, is_new ? "" : " exists already");
    std::fflush(stdout);
  }
  const fs::path inventory = fs::path(options.out) / "inventory.yml";
  write_file(inventory, format_inventory(classes, options.architectures.front()));
  fmt::print("{}: {}\n", inventory.string(), counted(classes.size(), "student"));
}

void add_sweep_packages(ProgramCommand& sweep) {
  auto options = std::make_shared<PackagesArguments>();
  ProgramCommand command = sweep.subcommand(
      "packages",
      "Debian packages of bess-edge by class of fleet members, and an Ansible inventory");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.option("--out", options->out, "output folder for inventory.yml and one folder per class")
      .value_name("DIR")
      .required();
  command
      .option("--arch", options->architectures,
              "architectures; most machines have the first (default arm64)")
      .one_of({"arm64", "armhf", "amd64"});
  command.option("--source", options->source, "source checkout, with tools/package").with_default();
  command.flag("--partial", options->partial, "skip fleet members without a proved student");
  command.footer(
      "Existing packages of the same student are kept.\n"
      "Example:\n  bess-train sweep packages sweeps/fleet --out debs --arch arm64 armhf --source "
      "~/bess");
  command.runs([options] { package_sweep(*options); });
}

}  // namespace

void add_sweep_commands(ProgramCommand& app) {
  ProgramCommand sweep = app.subcommand(
      "sweep", "many runs, local or on a cluster: plan, run, task, collect, packages");
  sweep.requires_subcommand();
  add_sweep_plan(sweep);
  add_sweep_run(sweep);
  add_sweep_task(sweep);
  add_sweep_collect(sweep);
  add_sweep_packages(sweep);
}

}  // namespace bess
