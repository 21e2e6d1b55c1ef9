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
    {"cold_power_share", [](auto& b) -> double& { return b.cold.power_share; }, 0.001, 1,
     "of the power, left in the cold hours of each local day; 1: there are none"},
    {"cold_from_hour", [](auto& b) -> double& { return b.cold.from_hour; }, 0, 24,
     "local, 22.5 is half past ten"},
    {"cold_to_hour", [](auto& b) -> double& { return b.cold.to_hour; }, 0, 24,
     "local; before cold_from_hour: they go over midnight"},
});

/// What keys that are each in range say against each other; null: nothing.
constexpr const char* battery_contradiction(const BatteryParameters& battery) {
  if (battery.soc_min_frac >= battery.soc_max_frac) return "soc_min must be below soc_max";
  if (battery.cold.exist() && battery.cold.from_hour == battery.cold.to_hour) {
    return "cold_power_share is below 1: set cold_from_hour and cold_to_hour, which differ";
  }
  return nullptr;
}

}  // namespace bess
