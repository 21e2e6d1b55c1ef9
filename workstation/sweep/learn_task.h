// The work of a task: the whole chain from its prices to a proved student and what that earns, on
// one thread, so that every machine with the same program makes the same bytes. A student that was
// not proved is a result as well.
#pragma once

#include "workstation/sweep/attempt.h"
#include "workstation/sweep/sweep_task.h"

namespace bess {

/// Throws UserError when the folder holds no such task, or the program is not the sweep's. Messages
/// go to the attempt's log.txt, which is not published.
TaskWork learning_work(const SweepFolder& folder, int task);

/// True of a result folder whose student was proved.
bool is_proved(const std::filesystem::path& result);

}  // namespace bess
