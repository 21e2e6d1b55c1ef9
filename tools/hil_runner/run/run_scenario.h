// Run and judgement of one scenario.
#pragma once

#include "tools/hil_runner/run/outcome.h"
#include "tools/hil_runner/wall/wall_run.h"

namespace bess {

/// Errors of the scenario are in the outcome. Throws Interrupted on a stop request.
Outcome run_scenario(const Scenario& scenario, bool in_virtual_time, const WallSite& site);

}  // namespace bess
