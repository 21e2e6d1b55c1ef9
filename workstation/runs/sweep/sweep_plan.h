// Sweep plan: validated tasks from plan file, options and fleet list, written before the first task
// starts. A repeated plan appends new tasks and keeps all numbers; a different plan, program or
// price file is refused.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/base/answer.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// Sweep folder: file names.
//
//   sweep.json      program, prices and kind of tasks
//   base.toml       configuration of all tasks
//   minutes.csv.gz  copy of the prices
//   rules/          rule files, by content
//   tasks.tsv       one task per line; only appended
//   sites.tsv       fleet members with their class
//   array.sbatch    Slurm script for one task
//   joblog          log of GNU parallel
//   tasks/000/000017        complete output of task 17
//   tasks/000/000017.part/  folders of running attempts
//   log/000017.txt          their log, until the task is complete

struct SweepFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path record() const { return path / "sweep.json"; }
  [[nodiscard]] std::filesystem::path base() const { return path / "base.toml"; }
  [[nodiscard]] std::filesystem::path prices() const { return path / "minutes.csv.gz"; }
  [[nodiscard]] std::filesystem::path rules(const std::string& stem) const {
    return path / "rules" / (stem + ".toml");
  }
  [[nodiscard]] std::filesystem::path tasks() const { return path / "tasks.tsv"; }
  [[nodiscard]] std::filesystem::path sites() const { return path / "sites.tsv"; }
  [[nodiscard]] std::filesystem::path array_script() const { return path / "array.sbatch"; }
  [[nodiscard]] std::filesystem::path joblog() const { return path / "joblog"; }
  /// At most a thousand per folder, for file system performance.
  [[nodiscard]] std::filesystem::path result(int task) const {
    return path / "tasks" / fmt::format("{:03}", task / 1000) / fmt::format("{:06}", task);
  }
  [[nodiscard]] std::filesystem::path parts(int task) const { return result(task) += ".part"; }
  [[nodiscard]] std::filesystem::path log(int task) const {
    return path / "log" / fmt::format("{:06}.txt", task);
  }
};

// Engines of a sweep: command of GNU parallel for this machine, and script and
// commands of a Slurm array. Other schedulers call `bess-train sweep task FOLDER NUMBER`.

/// Runs all tasks without a success in the joblog; `jobs` in parallel (default: one per core).
std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs = {});

/// Words quoted for a shell.
std::string shell_line(const std::vector<std::string>& words);

std::string array_script(const SweepFolder& folder);
/// One command per line, for up to a thousand tasks each.
std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks);

// Fleet members of a sweep, and classes that share a student (chain/run_config.h). Prices,
// seed, commit and instruction set are the same in a whole sweep.
//
// CSV, one line per member; only `id` is required:
//   id,battery,contract,rules,region,SECTION.KEY...
// battery, contract: configuration files in the folder of the CSV; rules: rule files, separated by
// spaces; a column named like a key contains its value. Empty fields keep the sweep's
// configuration.

struct Site {
  std::string id;
  std::string region;
  double power_w = 0;
  double capacity_wh = 0;
  std::string student;  ///< the class
};

// Task of a sweep: number and settings, one line of tasks.tsv.

/// Settings of a task that are not configuration keys.
namespace setting {
inline constexpr const char* kSeed = "seed";
inline constexpr const char* kFold = "fold";    ///< a month (run/run_backtest.h)
inline constexpr const char* kRules = "rules";  ///< stem of a file in rules/
inline constexpr const char* kClass = "class";  ///< of sites that share the student (sweep_plan.h)
}  // namespace setting

struct SweepTask {
  int number = 0;    ///< from 1
  Entries settings;  ///< those above, then "section.key" with its value in TOML

  [[nodiscard]] std::string value(std::string_view name) const { return value_in(settings, name); }
  [[nodiscard]] Entries without_seed_and_fold() const;
};

/// "seed=1 <tab> distil.fidelity=2", as in tasks.tsv; equal settings give equal text.
std::string settings_text(const Entries& settings);
/// For output: "seed 1, distil.fidelity 2".
std::string settings_shown(const Entries& settings);

struct SweepRequest {
  std::string plan;  ///< TOML file with [grid] and [[list]]; or empty
  std::string prices;
  PriceInput price_input;
  std::string config;              ///< of all tasks
  RuleFiles rules;                 ///< of all tasks
  std::string sites;               ///< CSV
  double c_rate_step_percent = 0;  ///< of rounded C-rates (chain/run_config.h)
  std::vector<std::string> sets;   ///< KEY=VALUES, added to the grid
  int seeds = 1;
  std::string folds;  ///< "monthly" or empty
  bool full = false;  ///< complete instead of lean runs
};

/// Content of sweep.json.
struct SweepRecord {
  std::string program;          ///< version, commit, compiler and instruction set
  std::string prices;           ///< by content
  std::string kind;             ///< "lean" or "full"
  std::int64_t date_utc_s = 0;  ///< SOURCE_DATE_EPOCH of all outputs
};

struct SweepPlan {
  SweepFolder folder;
  SweepRecord record;
  RunConfig base;
  std::map<std::string, std::string> rules;  ///< text by stem
  std::vector<SweepTask> tasks;              ///< previously planned tasks first
  std::vector<Site> sites;
  std::size_t known = 0;    ///< number of previously planned tasks
  std::size_t classes = 0;  ///< number of classes
};

/// Writes nothing. Throws UserError.
SweepPlan plan_sweep(const SweepRequest& request, const SweepFolder& folder);
void write_plan(const SweepPlan& plan, const SweepRequest& request);

/// Throws UserError when the folder contains no sweep.
SweepRecord load_sweep_record(const SweepFolder& folder);
/// The same; refuses a sweep planned by another program.
SweepRecord load_own_sweep(const SweepFolder& folder);
std::vector<SweepTask> load_tasks(const SweepFolder& folder);
/// Empty without fleet members.
std::vector<Site> load_sites(const SweepFolder& folder);

/// Configuration of a task, with its rules and one thread.
RunConfig config_of_task(const SweepFolder& folder, const RunConfig& base, const SweepTask& task);

}  // namespace bess
