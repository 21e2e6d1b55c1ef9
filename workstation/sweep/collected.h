// What a sweep came to: a row a task, seeds and months folded to a row of settings, a row a site.
// Read from the tasks' outputs, their tables of figures, never from their days: ten thousand of
// them are read in seconds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "workstation/sweep/sites.h"
#include "workstation/sweep/sweep_folder.h"
#include "workstation/sweep/sweep_task.h"

namespace bess {

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
