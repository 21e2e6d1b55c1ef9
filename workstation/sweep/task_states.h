// What became of the tasks of a sweep, by looking at its folders alone: no task is asked, no
// database is kept, and no program must live for it.
#pragma once

#include <cstdint>
#include <vector>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

enum class TaskState : std::uint8_t { kMissing, kProved, kUnproved, kFailed };

/// [number - 1]. Attempts on this machine whose program is gone are counted first.
std::vector<TaskState> task_states(const SweepFolder& folder, int count);

struct SweepCounts {
  int planned = 0;
  int proved = 0;
  int unproved = 0;  ///< done too: a failed proof is a result
  int failed = 0;    ///< so often that they are left alone
  int missing = 0;
  int attempts = 0;   ///< folders that somebody is, or was, at work in
  int different = 0;  ///< second copies that came to something else
};
SweepCounts counts_of(const SweepFolder& folder, const std::vector<TaskState>& states);

/// Numbers of the tasks that are still to be done.
std::vector<int> missing_tasks(const std::vector<TaskState>& states);

/// "1-4,9": and back. Throws UserError naming `where`.
std::string ranges_text(const std::vector<int>& numbers);
std::vector<int> parse_ranges(const std::string& text, const std::string& where);

}  // namespace bess
