// Battery parameter fit from a controller log (`bess-edge log --csv`): standby consumption, taper
// near full and empty, efficiency and its dependence on power, cold hours. A tick's reading shows
// the settled power of the previous control cycle's order. Delay, ramp and lag within a cycle need
// a recording: `bess-edge map check --steps`.
#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/cycle_log.h"

namespace bess {

struct Fitted {
  double value = 0;
  double standard_error = 0;
  int observations = 0;
};

/// Parameters found, by their names in [battery]; absent where the log shows nothing: too few such
/// cycles, or no effect above the noise.
using BatteryFit = std::map<std::string_view, Fitted>;

/// `battery` with the parameters found.
BatteryParameters with_fit(BatteryParameters battery, const BatteryFit& fit);

/// All `cycles` have a reading. Power, capacity and SoC window are those of `nameplate`. Throws
/// UserError if the log contradicts them: more than the rated power, or more energy out of the
/// cells than into them.
BatteryFit fit_battery(const std::vector<LoggedCycle>& cycles, const BatteryParameters& nameplate);

}  // namespace bess
