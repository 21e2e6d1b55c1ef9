// One task of a sweep, whoever runs it and however often: the whole chain from its prices to a
// proved student and what that earns, on one thread, so that every machine with the same program
// makes the same bytes. A student that was not proved is a result as well.
//
// Its files are made in a folder of its own beside the output folder, which one rename publishes.
// So a task that dies leaves nothing under the final name, and of two at once the second finds the
// name taken and has nothing to do.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>

#include "workstation/sweep/sweep_folder.h"

namespace bess {

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

}  // namespace bess
