// What a sweep is to be: read from a plan, its options and its sites, wholly validated, and written
// into the sweep's folder before task 1. Planned again with more, what is new is appended and every
// task keeps its number; another plan, program or other prices are refused, naming both.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/base/answer.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/chain/rule_files.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/sweep/sweep_folder.h"

namespace bess {

// Points of a sweep: what it varies, each some keys of the configuration with their values. Values
// are looked at where they are written, by the configuration's own list of keys.

/// Of a plan's file, or none when `plan` is empty: each [[list]] with every combination of [grid]
/// and of `sets`, KEY=VALUE[,VALUE...], the last of these fastest. One empty point when nothing
/// varies. Throws UserError naming file and line.
std::vector<Entries> read_points(const std::string& plan, const std::vector<std::string>& sets);

// The sites of a sweep, and the classes that share a student (chain/learning_class.h). Prices,
// seed, commit and instruction set are the same in a whole sweep.
//
// CSV, one line a site; only `id` must be there:
//   id,battery,contract,rules,region,SECTION.KEY...
// battery, contract: configuration files, beside the CSV, with their [battery], [costs] or other
// keys; rules: rule files, a space between; a column named like a key holds its value. What is
// empty stays as in the sweep's configuration.

struct Site {
  std::string id;
  std::string region;
  double power_w = 0;
  double capacity_wh = 0;
  std::string student;  ///< the class
};

/// What all sites of a class are learnt by.
struct SiteClass {
  std::string name;   ///< 16 hexadecimal digits of its key
  RunConfig config;   ///< at the canonical size
  std::string rules;  ///< as one file; empty: none
};

struct Sites {
  std::vector<Site> sites;
  std::vector<SiteClass> classes;  ///< in the order of their first site
};

/// Throws UserError naming file, line and column.
Sites read_sites(const std::filesystem::path& csv, const RunConfig& base,
                 double rate_step_percent = 0);

/// A site a line, with its class; and back.
std::string format_sites(const std::vector<Site>& sites);
std::vector<Site> parse_sites(const std::string& text, const std::string& name);

// One task of a sweep: its number and what sets it apart from all others. A line of tasks.tsv holds
// one, so that a task reads its own line and nobody counts axes twice.

/// Names among a task's settings that are no keys of the configuration.
namespace setting {
inline constexpr const char* kSeed = "seed";
inline constexpr const char* kFold = "fold";    ///< a month (run/run_backtest.h)
inline constexpr const char* kRules = "rules";  ///< the stem of a file in the sweep's rules/
inline constexpr const char* kClass = "class";  ///< of sites that share the student (sweep_plan.h)
}  // namespace setting

struct SweepTask {
  int number = 0;    ///< from 1
  Entries settings;  ///< those above, then "section.key" and its value as TOML writes it

  [[nodiscard]] std::string value(std::string_view name) const;  ///< empty: it has none
  [[nodiscard]] Entries without_seed_and_fold() const;
};

/// "seed=1 <tab> distil.fidelity=2": the same settings give the same text.
std::string settings_text(const Entries& settings);
/// For people: "seed 1, distil.fidelity 2".
std::string settings_shown(const Entries& settings);

std::string format_tasks(const std::vector<SweepTask>& tasks);
/// Throws UserError naming `name` and the line.
std::vector<SweepTask> parse_tasks(std::string_view text, const std::string& name);

struct SweepRequest {
  std::string plan;  ///< TOML file with [grid] and [[list]]; or empty
  std::string prices;
  PriceInput price_input;
  std::string config;              ///< that all tasks have in common
  RuleFiles rules;                 ///< the same
  std::string sites;               ///< CSV
  double c_rate_step_percent = 0;  ///< of rounded C-rates (chain/learning_class.h)
  std::vector<std::string> sets;   ///< KEY=VALUES, added to the grid
  int seeds = 1;
  std::string folds;  ///< "monthly" or empty
  bool full = false;  ///< whole runs with their pages, not lean ones
};

/// What a folder's sweep.json says: all tasks of a sweep are of one kind.
struct SweepRecord {
  std::string program;          ///< version, commit, compiler and instruction set
  std::string prices;           ///< by content
  std::string kind;             ///< "lean" or "full"
  std::int64_t date_utc_s = 0;  ///< of everything that is made: SOURCE_DATE_EPOCH
};

struct SweepPlan {
  SweepFolder folder;
  SweepRecord record;
  RunConfig base;
  std::map<std::string, std::string> rules;  ///< text by stem
  std::vector<SweepTask> tasks;              ///< those that were planned before first
  std::vector<Site> sites;
  std::size_t known = 0;    ///< tasks that were planned before
  std::size_t classes = 0;  ///< of sites
};

/// Writes nothing. Throws UserError.
SweepPlan plan_sweep(const SweepRequest& request, const SweepFolder& folder);
void write_plan(const SweepPlan& plan, const SweepRequest& request);

/// Throws UserError when the folder holds no sweep.
SweepRecord load_sweep_record(const SweepFolder& folder);
/// The same, and refuses another program than that which planned it.
SweepRecord load_own_sweep(const SweepFolder& folder);
std::vector<SweepTask> load_tasks(const SweepFolder& folder);
/// None without sites.
std::vector<Site> load_sites(const SweepFolder& folder);

/// The configuration of a task, its rules and its one thread included.
RunConfig config_of_task(const SweepFolder& folder, const RunConfig& base, const SweepTask& task);

}  // namespace bess
