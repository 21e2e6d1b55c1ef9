// The keys of a battery, [battery] of a configuration: one table for the workstation, which plans
// with it, and for the simulator, which acts it.
#pragma once

#include <array>

#include "shared/battery_model.h"

namespace bess {

struct BatteryKey {
  const char* name;
  double& (*of)(BatteryParameters&);
  double low, high;
  const char* comment;
};

inline constexpr auto kBatteryKeys = std::to_array<BatteryKey>({
    {"power_w", [](auto& b) -> double& { return b.power_w_max; }, 1, 1e9,
     "both directions, grid side"},
    {"capacity_wh", [](auto& b) -> double& { return b.capacity_wh; }, 1, 1e10,
     "usable and not usable"},
    {"charge_efficiency", [](auto& b) -> double& { return b.charge_efficiency; }, 0.5, 1,
     "grid to battery"},
    {"discharge_efficiency", [](auto& b) -> double& { return b.discharge_efficiency; }, 0.5, 1,
     "battery to grid"},
    {"soc_min", [](auto& b) -> double& { return b.soc_min_frac; }, 0, 0.95,
     "lower end of the SoC window"},
    {"soc_max", [](auto& b) -> double& { return b.soc_max_frac; }, 0.05, 1,
     "upper end of the SoC window"},
    {"charge_taper_width", [](auto& b) -> double& { return b.charge_taper.width_frac; }, 0, 1,
     "of SoC below soc_max, in which the charging power falls; 0: it does not"},
    {"charge_taper_share", [](auto& b) -> double& { return b.charge_taper.share; }, 0.001, 1,
     "of the power, left at soc_max"},
    {"discharge_taper_width", [](auto& b) -> double& { return b.discharge_taper.width_frac; }, 0, 1,
     "of SoC above soc_min, in which the discharging power falls; 0: it does not"},
    {"discharge_taper_share", [](auto& b) -> double& { return b.discharge_taper.share; }, 0.001, 1,
     "of the power, left at soc_min"},
    {"full_power_loss", [](auto& b) -> double& { return b.full_power_loss_frac; }, 0, 0.3,
     "of the power, lost at full power besides the efficiencies; a quarter of that at half"},
    {"standby_w", [](auto& b) -> double& { return b.standby_w; }, 0, 1e8,
     "own consumption, bought at any time"},
    {"delay_s", [](auto& b) -> double& { return b.response.delay_s; }, 0, 120,
     "from an order until its power begins"},
    {"ramp_w_per_s", [](auto& b) -> double& { return b.response.ramp_w_per_s; }, 0, 1e9,
     "of its power; 0: at once"},
    {"time_constant_s", [](auto& b) -> double& { return b.response.time_constant_s; }, 0, 600,
     "of a first-order lag behind the ramp; planned as if there were none of the three"},
});

}  // namespace bess
