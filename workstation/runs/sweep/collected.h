// Collected sweep results: one row per task, per setting (seeds and months combined) and per fleet
// member. Reads only the tables of results, not the days: ten thousand tasks take seconds.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {

// Task of a sweep: the whole chain on one thread, so that every machine with the same program makes
// the same bytes. An unproved student is a result too.
//
// Files are made in a separate folder, which one rename publishes. A task that dies leaves nothing
// under the final name; of two parallel attempts the second finds the name taken.

/// Makes the files of a task, including run.json, in an empty folder.
using TaskWork = std::function<void(const std::filesystem::path& folder, std::FILE* log)>;

/// Start of the last line in a failed task's log.
inline constexpr const char* kFailedLine = "failed: ";

/// False when the output was already complete. Exceptions of `work` are logged and rethrown.
bool complete_task(const SweepFolder& folder, int task, const TaskWork& work);

/// Runs the task's own work. Throws UserError when there is no such task, or when program or prices
/// differ from the sweep's.
bool run_task(const SweepFolder& folder, int task);

/// A folder without run.json is incomplete.
bool is_complete(const SweepFolder& folder, int task);
/// True for a complete task whose student was proved.
bool is_proved(const SweepFolder& folder, int task);

/// kProved and kUnproved are complete: a failed proof is a result.
enum class TaskState : std::uint8_t { kProved, kUnproved, kFailed, kMissing };

/// Results of the exported student on test days; EUR per day per MWh of capacity.
struct TaskFigures {
  double profit = 0;  ///< SoC carried over
  double cycles_per_day = 0;
  std::string columns;  ///< of tasks.csv, from days to weights_hash
};

struct CollectedTask {
  SweepTask task;
  TaskState state = TaskState::kMissing;
  std::optional<TaskFigures> figures = {};  ///< of a proved student
  double seconds = 0;                       ///< of one core; 0: unknown
  std::string said = {};  ///< last line of its log; empty: complete, or not started
};

struct CollectedSite {
  Site site;
  int tasks = 0, proved = 0;
  double profit_sum = 0;    ///< over the proved tasks of its class
  std::string header = {};  ///< of the first of them; empty: none

  [[nodiscard]] double profit() const { return profit_sum / proved; }
  /// Of the whole battery.
  [[nodiscard]] double eur_per_day() const { return profit() * site.capacity_wh / 1e6; }
};

/// Throws UserError naming file and line of a damaged output.
std::vector<CollectedTask> collect_tasks(const SweepFolder& folder,
                                         const std::vector<SweepTask>& tasks);
std::vector<CollectedSite> collect_sites(const SweepFolder& folder,
                                         const std::vector<CollectedTask>& tasks,
                                         const std::vector<Site>& sites);

std::string tasks_csv(const std::vector<CollectedTask>& tasks);
/// One row per setting, seeds and months combined. The standard error is over months, or over seeds
/// for a single month.
std::string settings_csv(const std::vector<CollectedTask>& tasks);
std::string sites_csv(const std::vector<CollectedSite>& sites);

// Packages of a sweep: for each class of fleet members a folder with header,
// signature and Debian packages (tools/package); and an inventory for tools/delivery/ansible with
// package, expected student and rollout share.

struct PackageRequest {
  std::filesystem::path source;  ///< source checkout with tools/package
  std::filesystem::path out;
  std::vector<std::string> architectures;  ///< Debian names; the first is used in the inventory
};

struct PackagedClass {
  std::string name;
  std::vector<CollectedSite> sites;  ///< each with a header
  std::string student;               ///< after packaging: hash reported by the program
  std::string version;
};

/// In the order of their first member. Throws UserError when a member has no proved student (with
/// `partial` it is skipped) or its id is not a host name.
std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial);

/// Makes the packages; false if they existed. Throws UserError with the last line of
/// tools/package.
bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one);

/// 1, 10 or 100, by the id only, so that added members do not change the share of others.
int rollout_percent(const std::string& id);

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture);

}  // namespace bess
