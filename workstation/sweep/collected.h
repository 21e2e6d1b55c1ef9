// What a sweep came to: a row a task, seeds and months folded to a row of settings, a row a site.
// Read from what the tasks published, their tables of figures, never from their days: ten thousand
// of them are read in seconds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/sweep/sites.h"
#include "workstation/sweep/sweep_folder.h"
#include "workstation/sweep/sweep_task.h"
#include "workstation/sweep/task_states.h"

namespace bess {

/// Of the exported student on test days; EUR per day per MWh of capacity.
struct TaskFigures {
  double profit = 0;  ///< carried over from day to day
  std::optional<double> standard_error, standard_error_by_month;
  std::optional<double> gain;  ///< over the rule-based baseline, day by day
  double profit_at_wear_10 = 0;
  double profit_day_reset = 0;
  double cycles_per_day = 0;
  std::optional<double> share_of_foresight;
  int days = 0;
  std::string weights_hash;
};

struct CollectedTask {
  SweepTask task;
  TaskState state = TaskState::kMissing;
  std::optional<TaskFigures> figures;  ///< of a proved one
  double seconds = 0;                  ///< of one core; 0: not told
};

/// All tasks of the same settings, seeds and months folded.
struct FoldedSettings {
  Entries settings;  ///< without seed and fold
  int tasks = 0, proved = 0;
  double mean = 0;                       ///< of the profit over months of the mean over seeds
  std::optional<double> standard_error;  ///< over months, or over seeds where there is one month
  double low = 0, high = 0;
  double cycles_per_day = 0;
};

struct CollectedSite {
  Site site;
  int tasks = 0, proved = 0;
  std::optional<double> profit;       ///< mean over the proved tasks of its class, at their C-rate
  std::optional<double> eur_per_day;  ///< of the whole battery, at its own C-rate
  std::string header;                 ///< of its first proved task; empty: none
  /// Of that task, where its C-rate is a rounded one: at the site's own (own_rate.h).
  std::optional<double> profit_at_own_rate = {}, rounding_loss_at_most = {};
};

/// Throws UserError naming file and line of a damaged result.
std::vector<CollectedTask> collect_tasks(const SweepFolder& folder,
                                         const std::vector<SweepTask>& tasks,
                                         const std::vector<TaskState>& states);
/// What a task took of one core: the mean of the first hundred that are done; 0: none is.
double mean_seconds(const SweepFolder& folder, const std::vector<TaskState>& states);
std::vector<FoldedSettings> fold_seeds(const std::vector<CollectedTask>& tasks);
std::vector<CollectedSite> collect_sites(const SweepFolder& folder,
                                         const std::vector<CollectedTask>& tasks,
                                         const std::vector<Site>& sites);

/// Names of settings that not all tasks have alike, seed and fold first.
std::vector<std::string> varying_settings(const std::vector<CollectedTask>& tasks);
/// "proved", "not proved", "failed", "missing".
std::string state_name(TaskState state);

std::string tasks_csv(const std::vector<CollectedTask>& tasks);
std::string sites_csv(const std::vector<CollectedSite>& sites);

}  // namespace bess
