// What a sweep is to be: read from a plan, its options and its sites, wholly validated, and written
// into the sweep's folder before task 1. Planned again with more, what is new is appended and every
// task keeps its number; another plan, program or other prices are refused, naming both.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "workstation/chain/price_input.h"
#include "workstation/sweep/axes.h"
#include "workstation/sweep/sites.h"
#include "workstation/sweep/sweep_folder.h"
#include "workstation/sweep/sweep_task.h"

namespace bess {

struct SweepRequest {
  std::string plan;  ///< TOML file; empty: the options alone
  std::string prices;
  PriceInput price_input;
  std::string config;             ///< that all tasks have in common; besides the plan's own
  std::vector<std::string> sets;  ///< KEY=VALUES
  int seeds = 0;                  ///< 0: as the plan says
  std::string folds;              ///< "monthly" or empty
  std::string sites;              ///< CSV
  bool full = false;              ///< whole runs with their pages, not lean ones
};

/// What a folder's sweep.json says: all tasks of a sweep are of one kind.
struct SweepRecord {
  std::string id;               ///< 8 digits, by which jobs of an engine are known
  std::string program;          ///< version, commit, compiler and instruction set
  std::string prices;           ///< by content
  std::string prices_name;      ///< as they were given
  std::string kind;             ///< "lean" or "full"
  std::int64_t date_utc_s = 0;  ///< of everything that is made: SOURCE_DATE_EPOCH
};

struct SweepPlan {
  SweepFolder folder;
  SweepRecord record;
  RunConfig base;
  std::vector<std::pair<std::string, std::string>> rules;  ///< stem and text
  std::vector<SweepTask> tasks;                            ///< those that were planned before first
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

/// What tasks are likely to take of one core, and of the disk.
struct SweepEstimate {
  double seconds = 0;
  double bytes = 0;
};
/// Of the tasks that are new.
SweepEstimate estimate_of(const SweepPlan& plan);

}  // namespace bess
