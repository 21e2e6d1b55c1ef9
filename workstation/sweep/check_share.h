// Some tasks of a finished sweep once more, on this machine: what they make must be what is there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "workstation/sweep/attempt.h"

namespace bess {

/// `percent` of `done`, at least one, drawn by `seed`; in order.
std::vector<int> drawn_share(const std::vector<int>& done, double percent, std::uint64_t seed);

/// The files of the task that are not what was published: "NAME: MARK there and MARK here"; none
/// when all are. Leaves nothing behind.
std::vector<std::string> check_task(const SweepFolder& folder, int task, const TaskWork& work);

}  // namespace bess
