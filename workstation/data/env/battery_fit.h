// What a battery really does, learnt from the log of its controller (`bess-edge log --csv`): own
// consumption, taper towards full and empty, efficiency and how it falls with power, cold hours. A
// tick's reading shows the order of the cycle before, long settled; what happens within a cycle,
// delay, ramp and lag, such a log cannot show: `bess-edge map check --steps` reads those from a
// recording.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/cycle_log.h"

namespace bess {

struct Fitted {
  double value = 0;
  double standard_error = 0;
  int observations = 0;
};

/// Nothing where the log does not show it: too few such cycles, or no more than the noise.
struct BatteryFit {
  std::optional<Fitted> standby_w;
  std::optional<Fitted> charge_taper_width, charge_taper_share;
  std::optional<Fitted> discharge_taper_width, discharge_taper_share;
  std::optional<Fitted> charge_efficiency, discharge_efficiency;
  std::optional<Fitted> full_power_loss;
  std::optional<Fitted> cold_power_share, cold_from_hour, cold_to_hour;

  /// What was found, under the names of [battery].
  [[nodiscard]] std::vector<std::pair<std::string, Fitted>> found() const;
  /// `battery` with what was found.
  [[nodiscard]] BatteryParameters applied_to(BatteryParameters battery) const;
};

/// All `cycles` have a reading. Power, capacity and SoC window are those of `nameplate`. Throws
/// UserError where the log says that they cannot be: more power than it has, or cells that give
/// back more than they were given.
BatteryFit fit_battery(const std::vector<LoggedCycle>& cycles, const BatteryParameters& nameplate);

}  // namespace bess
