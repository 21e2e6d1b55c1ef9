// bess-train sweep run: the missing tasks, here side by side or sent to Slurm.
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/folder_lock.h"
#include "workstation/cli/commands.h"
#include "workstation/sweep/collected.h"
#include "workstation/sweep/learn_task.h"
#include "workstation/sweep/slurm.h"
#include "workstation/sweep/sweep_plan.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct SweepRunArguments {
  std::string folder;
  std::optional<int> jobs;
  bool slurm = false;
  SlurmRequest request;
  std::string chunk = "auto";
  bool again = false;
};

struct Todo {
  SweepFolder folder;
  SweepRecord record;
  SweepCounts counts;
  std::vector<TaskState> states;
  std::vector<int> missing;
};

Todo look_at_sweep(const SweepRunArguments& options) {
  Todo todo;
  todo.folder = {options.folder};
  todo.record = load_own_sweep(todo.folder);
  if (options.again) fs::remove_all(todo.folder.path / "failures");
  todo.states = task_states(todo.folder, static_cast<int>(load_tasks(todo.folder).size()));
  todo.counts = counts_of(todo.folder, todo.states);
  todo.missing = missing_tasks(todo.states);
  return todo;
}

/// Of one task: as those took that are done, else as planned; the machinery's own at the least.
double seconds_of_task(const Todo& todo, const SweepFolder& folder) {
  constexpr double kMachinery_s = 0.01;
  const double done_s = mean_seconds(folder, todo.states);
  if (done_s > 0) return std::max(done_s, kMachinery_s);
  SweepPlan plan;
  plan.record = todo.record;
  plan.base = load_run_config(folder.base());
  plan.tasks = load_tasks(folder);
  return estimate_of(plan).seconds / static_cast<double>(plan.tasks.size());
}

void require_none_failed(int failed, const SweepFolder& folder) {
  if (failed == 0) return;
  fail("{} failed, {} says why; mend it, then 'bess-train sweep run {} --again'",
       counted(static_cast<std::size_t>(failed), "task"), (folder.path / "failures").string(),
       folder.path.string());
}

void run_here_now(const SweepRunArguments& options) {
  const Todo todo = look_at_sweep(options);
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int jobs = options.jobs.value_or(cores);
  fmt::print("{}: {} of {} to do, {} at once\n", options.folder, todo.missing.size(),
             counted(static_cast<std::size_t>(todo.counts.planned), "task"), jobs);
  std::fflush(stdout);
  const RunHereResult result = learn_here(todo.folder, todo.missing, jobs);
  require_none_failed(result.failed + todo.counts.failed, todo.folder);
}

void send_to_slurm(SweepRunArguments& options) {
  if (options.chunk != "auto") options.request.chunk = std::atoi(options.chunk.c_str());
  const Todo todo = look_at_sweep(options);
  const FolderLock lock(todo.folder.path);  // of two clients here one sends
  if (!todo.missing.empty()) options.request.task_s = seconds_of_task(todo, todo.folder);
  const Submission sent = submit(todo.folder, todo.record.id, todo.missing, options.request);
  const int done = todo.counts.proved + todo.counts.unproved;
  if (sent.tasks == 0) {
    fmt::print("{}: nothing to send: {} of {} done, {} wait or run, {} failed\n", options.folder,
               done, todo.counts.planned, sent.waiting, todo.counts.failed);
    return require_none_failed(todo.counts.failed, todo.folder);
  }
  fmt::print(
      "{}\njob {}: {} in {} of {} each (about {:.0f} s at {:.3g} s a task), {} done, {} wait or "
      "run "
      "already\n",
      sent.command, sent.job, counted(static_cast<std::size_t>(sent.tasks), "task"),
      counted(static_cast<std::size_t>(sent.elements), "element"), sent.chunk,
      sent.chunk * options.request.task_s, options.request.task_s, done, sent.waiting);
  const int later = static_cast<int>(todo.missing.size()) - sent.waiting - sent.tasks;
  if (later > 0) fmt::print("{} more than Slurm takes at once: call again later\n", later);
}

}  // namespace

void add_sweep_run(ProgramCommand& sweep) {
  auto options = std::make_shared<SweepRunArguments>();
  ProgramCommand command =
      sweep.subcommand("run", "Do what is missing: here, or with --slurm on a cluster");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.option("--jobs", options->jobs, "Tasks at once, one core each (default: all cores)")
      .range(1, 1024);
  command
      .flag("--slurm", options->slurm,
            "Send what is missing and does not wait to Slurm as one array, and leave")
      .excludes("--jobs");
  command.option("--at-once", options->request.at_once, "Slurm: elements that run at once")
      .range(1, 100'000)
      .with_default()
      .needs("--slurm");
  command.option("--chunk", options->chunk, "Slurm: tasks an element, or auto: a minute of them")
      .with_default()
      .needs("--slurm")
      .check([](const std::string& text) -> std::string {
        const bool is_number = !text.empty() && text.size() < 6 && text[0] != '0' &&
                               text.find_first_not_of("0123456789") == text.npos;
        return is_number || text == "auto" ? "" : "use auto or a number, 1 to 99999";
      });
  command.flag("--again", options->again, "Forget failures: try again what had failed three times");
  command.option("options", options->request.options, "Behind --: options for sbatch");
  command.footer(
      "A task is tried three times; a proof that fails is a result. Called again, it goes on with "
      "what is missing.\n"
      "Examples:\n"
      "  bess-train sweep run sweeps/first --jobs 4\n"
      "  bess-train sweep run sweeps/first --slurm\n"
      "  bess-train sweep run sweeps/first --slurm --at-once 64 -- --partition=main "
      "--time=2:00:00");
  command.runs([options] {
    if (!options->slurm && !options->request.options.empty()) {
      fail("options behind -- are sbatch's: add --slurm");
    }
    options->slurm ? send_to_slurm(*options) : run_here_now(*options);
  });
}

}  // namespace bess
