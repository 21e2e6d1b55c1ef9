// Keys of [battery] in a configuration: one table for planning on the workstation and for the
// simulator.
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
     "nominal, including the unusable part"},
    {"charge_efficiency", [](auto& b) -> double& { return b.charge_efficiency; }, 0.5, 1,
     "grid to battery"},
    {"discharge_efficiency", [](auto& b) -> double& { return b.discharge_efficiency; }, 0.5, 1,
     "battery to grid"},
    {"soc_min", [](auto& b) -> double& { return b.soc_min_frac; }, 0, 0.95,
     "lower end of the SoC window"},
    {"soc_max", [](auto& b) -> double& { return b.soc_max_frac; }, 0.05, 1,
     "upper end of the SoC window"},
    {"charge_taper_width", [](auto& b) -> double& { return b.charge_taper.width_frac; }, 0, 1,
     "SoC range below soc_max with reduced charging power; 0: none"},
    {"charge_taper_share", [](auto& b) -> double& { return b.charge_taper.share; }, 0.001, 1,
     "share of the power at soc_max"},
    {"discharge_taper_width", [](auto& b) -> double& { return b.discharge_taper.width_frac; }, 0, 1,
     "SoC range above soc_min with reduced discharging power; 0: none"},
    {"discharge_taper_share", [](auto& b) -> double& { return b.discharge_taper.share; }, 0.001, 1,
     "share of the power at soc_min"},
    {"full_power_loss", [](auto& b) -> double& { return b.full_power_loss_frac; }, 0, 0.3,
     "additional loss at full power, as share of it; quadratic in power"},
    {"standby_w", [](auto& b) -> double& { return b.standby_w; }, 0, 1e8,
     "own consumption from the grid"},
    {"delay_s", [](auto& b) -> double& { return b.response.delay_s; }, 0, 120,
     "dead time of an order"},
    {"ramp_w_per_s", [](auto& b) -> double& { return b.response.ramp_w_per_s; }, 0, 1e9,
     "ramp of the power; 0: immediate"},
    {"time_constant_s", [](auto& b) -> double& { return b.response.time_constant_s; }, 0, 600,
     "first-order lag after the ramp; planning ignores delay, ramp and lag"},
    {"cold_power_share", [](auto& b) -> double& { return b.cold.power_share; }, 0.001, 1,
     "share of the power in cold hours of a local day; 1: none"},
    {"cold_from_hour", [](auto& b) -> double& { return b.cold.from_hour; }, 0, 24,
     "local time; 22.5 is 22:30"},
    {"cold_to_hour", [](auto& b) -> double& { return b.cold.to_hour; }, 0, 24,
     "local time; before cold_from_hour: next day"},
});

/// Contradiction between keys that are each in range; null: none.
constexpr const char* battery_contradiction(const BatteryParameters& battery) {
  if (battery.soc_min_frac >= battery.soc_max_frac) return "soc_min must be below soc_max";
  if (battery.cold.exist() && battery.cold.from_hour == battery.cold.to_hour) {
    return "cold_power_share below 1 requires different cold_from_hour and cold_to_hour";
  }
  return nullptr;
}

}  // namespace bess
