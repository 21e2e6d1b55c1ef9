// A sweep on this machine: its missing tasks side by side, each a process of its own, so that one
// that dies takes nothing along. Another `run` in the same folder does no harm.
#pragma once

#include <cstdio>
#include <functional>
#include <vector>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

/// Does one task, in a process that is forked for it: what was read before is there, and costs
/// neither time nor memory again. What it throws is said in the log.
using TaskProgram = std::function<void(int task)>;

/// What came of it; tasks that were published meanwhile by others among them.
struct RunHereResult {
  int ran = 0;
  int failed = 0;  ///< given up
};

/// Tries each of `tasks` until it is published or has failed too often; `jobs` at once. What tasks
/// say goes to the sweep's log folder, a line for each that ended to `messages`. Throws Interrupted
/// after Ctrl-C or TERM, having ended what it started. No other thread may run.
RunHereResult run_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs,
                       const TaskProgram& program, std::FILE* messages);

}  // namespace bess
