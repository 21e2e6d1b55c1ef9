// One scenario, run and judged.
#pragma once

#include "tools/hil_runner/run/outcome.h"
#include "tools/hil_runner/wall/wall_run.h"

namespace bess {

/// Never throws for what the scenario does, that is an outcome; throws Interrupted when a stop was
/// requested.
Outcome run_scenario(const Scenario& scenario, bool in_virtual_time, const WallSite& site);

}  // namespace bess
