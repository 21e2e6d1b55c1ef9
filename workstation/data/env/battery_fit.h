// Battery parameter fit from a controller log (`bess-edge log --csv`): standby consumption, taper
// near full and empty, efficiency and its dependence on power, cold hours. A tick's reading shows
// the settled power of the previous control cycle's order. Delay, ramp and lag within a cycle need
// a recording: `bess-edge map check --steps`.
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

/// Empty where the log shows nothing: too few such cycles, or no effect above the noise.
struct BatteryFit {
  std::optional<Fitted> standby_w;
  std::optional<Fitted> charge_taper_width, charge_taper_share;
  std::optional<Fitted> discharge_taper_width, discharge_taper_share;
  std::optional<Fitted> charge_efficiency, discharge_efficiency;
  std::optional<Fitted> full_power_loss;
  std::optional<Fitted> cold_power_share, cold_from_hour, cold_to_hour;

  /// The parameters found, under the names of [battery].
  [[nodiscard]] std::vector<std::pair<std::string, Fitted>> found() const;
  /// `battery` with the parameters found.
  [[nodiscard]] BatteryParameters applied_to(BatteryParameters battery) const;
};

/// All `cycles` have a reading. Power, capacity and SoC window are those of `nameplate`. Throws
/// UserError if the log contradicts them: more than the rated power, or more energy out of the
/// cells than into them.
BatteryFit fit_battery(const std::vector<LoggedCycle>& cycles, const BatteryParameters& nameplate);

}  // namespace bess
