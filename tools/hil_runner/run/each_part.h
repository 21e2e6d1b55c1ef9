// Whether a scenario can fail: it is run without each of its parts, and each time must differ.
#pragma once

#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

/// A finding for each part that changes nothing and is not excused, and for each excuse of one
/// that does. `outcome` is of the whole scenario in virtual time. Throws Interrupted when a stop
/// was requested.
std::vector<Finding> judge_parts(const Outcome& outcome);

}  // namespace bess
