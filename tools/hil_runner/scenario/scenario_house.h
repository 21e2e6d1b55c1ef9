// The load of a scenario's house, for the simulators of both times and for the judge.
#pragma once

#include <string>

#include "tools/battery_sim/house_load.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// A file for bess-sim battery --house, an hour wider than the scenario on both sides. Of a house
/// with steps alone.
std::string house_csv(const Scenario& scenario);

HouseLoad house_load(const Scenario& scenario);

}  // namespace bess
