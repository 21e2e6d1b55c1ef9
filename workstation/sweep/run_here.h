// A sweep on this machine: its missing tasks side by side, each a program of its own, so that one
// that dies takes nothing along. Another `run` in the same folder does no harm.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

/// How one task is run: a program and its arguments, before which no shell stands. "{}" is the
/// task's number.
using TaskCommand = std::vector<std::string>;

/// What came of it; tasks that were published meanwhile by others among them.
struct RunHereResult {
  int ran = 0;
  int failed = 0;  ///< given up
};

/// Tries each of `tasks` until it is published or has failed too often; `jobs` at once. What tasks
/// say goes to the sweep's log folder, a line for each that ended to `messages`. Throws Interrupted
/// after Ctrl-C, having ended what it started.
RunHereResult run_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs,
                       const TaskCommand& command, std::FILE* messages);

}  // namespace bess
