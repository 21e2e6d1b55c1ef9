#include "workstation/cli/config_plausibility.h"

#include <fmt/core.h>

#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr double kPowerMin_w = 100, kCapacityMin_wh = 100;
constexpr double kRateMin_per_h = 0.05, kRateMax_per_h = 20;
constexpr double kRoundTripMin = 0.6;

}  // namespace

void require_plausible(const RunConfig& config, const std::string& name) {
  const BatteryParameters& battery = config.battery;
  if (battery.power_w_max < kPowerMin_w) {
    fail("{}: [battery] power_w = {:g} is below {:g} W; the unit is watt, 5 MW is 5000000", name,
         battery.power_w_max, kPowerMin_w);
  }
  if (battery.capacity_wh < kCapacityMin_wh) {
    fail(
        "{}: [battery] capacity_wh = {:g} is below {:g} Wh; the unit is watt-hour, 10 MWh is "
        "10000000",
        name, battery.capacity_wh, kCapacityMin_wh);
  }
  const double rate_per_h = battery.power_w_max / battery.capacity_wh;
  if (!(rate_per_h >= kRateMin_per_h && rate_per_h <= kRateMax_per_h)) {
    fail(
        "{}: [battery] power_w = {:g} and capacity_wh = {:g} are {:.2g} C; batteries have {:g} to "
        "{:g} C: is one of them in kW or MW?",
        name, battery.power_w_max, battery.capacity_wh, rate_per_h, kRateMin_per_h, kRateMax_per_h);
  }
  const double round_trip = battery.charge_efficiency * battery.discharge_efficiency;
  if (round_trip < kRoundTripMin || round_trip >= 1) {
    fmt::print(
        stderr,
        "bess-train: warning: {}: [battery] charge_efficiency {:g} times "
        "discharge_efficiency {:g} is {:.2f} from grid to grid; batteries have 0.8 to 0.95\n",
        name, battery.charge_efficiency, battery.discharge_efficiency, round_trip);
  }
}

}  // namespace bess
