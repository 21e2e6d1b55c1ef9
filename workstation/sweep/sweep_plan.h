// What a sweep is to be: read from a plan, its options and its sites, wholly validated, and written
// into the sweep's folder before task 1. Planned again with more, what is new is appended and every
// task keeps its number; another plan, program or other prices are refused, naming both.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "workstation/chain/price_input.h"
#include "workstation/chain/rule_files.h"
#include "workstation/sweep/sites.h"
#include "workstation/sweep/sweep_folder.h"
#include "workstation/sweep/sweep_task.h"

namespace bess {

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
