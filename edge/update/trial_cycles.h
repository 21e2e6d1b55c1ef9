// The cycles of a controller, as its own program tells them: `bess-edge log --csv`, whose columns
// keep their names over versions. A program that cannot tell has no good cycle.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "edge/update/trial.h"

namespace bess {

struct SeenCycle {
  std::string name;         ///< "UTC CYCLE": which one it is
  std::int64_t number = 0;  ///< since its process started
  bool is_cycle = true;     ///< false: what a process writes at its end
  TrialCycle cycle;
};

/// Oldest first. `must_write`: the settings say control, so that a cycle without an order is lost.
std::vector<SeenCycle> cycles_of_csv(std::string_view csv, bool must_write);

/// Asks `program` for its last cycles.
std::vector<SeenCycle> last_cycles(const std::string& program, const std::string& settings,
                                   bool must_write);

/// Whether the settings say `control = true`, as far as this program can read them.
bool wants_control(const std::string& settings);

/// Counts into `state` what it has not seen of the process that it judges.
/// True when there was a good cycle among them.
bool count_new_cycles(TrialState& state, const std::vector<SeenCycle>& cycles,
                      const TrialLimits& limits);

}  // namespace bess
