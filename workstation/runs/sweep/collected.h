// What a sweep came to: a row a task, seeds and months folded to a row of settings, a row a site.
// Read from the tasks' outputs, their tables of figures, never from their days: ten thousand of
// them are read in seconds.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "workstation/runs/sweep/sweep_folder.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {

// One task of a sweep, whoever runs it and however often: the whole chain from its prices to a
// proved student and what that earns, on one thread, so that every machine with the same program
// makes the same bytes. A student that was not proved is a result as well.
//
// Its files are made in a folder of its own beside the output folder, which one rename publishes.
// So a task that dies leaves nothing under the final name, and of two at once the second finds the
// name taken and has nothing to do.

/// Makes the files of a task, run.json among them, in an empty folder.
using TaskWork = std::function<void(const std::filesystem::path& folder, std::FILE* log)>;

/// The last line of a failed task's log begins with it.
inline constexpr const char* kFailedLine = "failed: ";

/// False when the output was complete before. What `work` throws is noted in the log and thrown
/// again.
bool complete_task(const SweepFolder& folder, int task, const TaskWork& work);

/// The same with a task's own work. Throws UserError when there is no such task, or when the
/// program or the prices are not the sweep's.
bool run_task(const SweepFolder& folder, int task);

/// A folder without its record is half of an output, as a copy by hand leaves it: no output.
bool is_complete(const SweepFolder& folder, int task);
/// True of a complete task whose student was proved.
bool is_proved(const SweepFolder& folder, int task);

/// Complete are kProved and kUnproved: a proof that fails is a result.
enum class TaskState : std::uint8_t { kProved, kUnproved, kFailed, kMissing };

/// Of the exported student on test days; EUR per day per MWh of capacity.
struct TaskFigures {
  double profit = 0;  ///< carried over from day to day
  double cycles_per_day = 0;
  std::string columns;  ///< of tasks.csv, from days to weights_hash
};

struct CollectedTask {
  SweepTask task;
  TaskState state = TaskState::kMissing;
  std::optional<TaskFigures> figures = {};  ///< of a proved one
  double seconds = 0;                       ///< of one core; 0: not told
  std::string said = {};  ///< the last line of its log; empty: it is complete, or never began
};

struct CollectedSite {
  Site site;
  int tasks = 0, proved = 0;
  double profit_sum = 0;    ///< over the proved tasks of its class
  std::string header = {};  ///< of the first of them; empty: there is none

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
/// A row for all tasks of the same settings, seeds and months folded. The standard error is over
/// months, or over seeds where there is one month.
std::string settings_csv(const std::vector<CollectedTask>& tasks);
std::string sites_csv(const std::vector<CollectedSite>& sites);

}  // namespace bess
