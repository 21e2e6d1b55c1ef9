// The work of a task: the whole chain from its prices to a proved student and what that earns, on
// one thread, so that every machine with the same program makes the same bytes. A student that was
// not proved is a result as well.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/market/series/judged_prices.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/run_here.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {

/// What the tasks of a sweep have in common, read once: processes that are forked share it.
class LearningTasks {
 public:
  /// Throws UserError when the program is not the sweep's.
  explicit LearningTasks(const SweepFolder& folder);
  /// Before anything is forked; otherwise the first task that is worked at reads them. Throws
  /// UserError when they are not the sweep's.
  const MinuteSeries& prices();
  /// Messages go to the attempt's log.txt, which is not published. Throws UserError when there is
  /// no such task.
  TaskWork work(int task);

 private:
  SweepFolder folder_;
  SweepRecord sweep_;
  RunConfig base_;
  std::string tasks_;
  std::optional<MinuteSeries> series_;
};

/// Many of them, `jobs` at once (run_here.h).
RunHereResult learn_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs);

/// Says what came of one; throws UserError when another copy came to something else.
void say_end(const SweepFolder& folder, int task, TaskEnd end);

/// True of a result folder whose student was proved.
bool is_proved(const std::filesystem::path& result);

}  // namespace bess
