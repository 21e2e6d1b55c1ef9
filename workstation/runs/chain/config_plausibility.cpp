#include <fmt/core.h>

#include <algorithm>

#include "shared/host/user_error.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {
namespace {

constexpr double kPowerMin_w = 100, kCapacityMin_wh = 100;
constexpr double kRateMin_per_h = 0.05, kRateMax_per_h = 20;
constexpr double kRoundTripMin = 0.6;

/// Time per transition of C51, the slower method, core-s: 8,000 steps of 4,096 take two minutes on
/// two cores (November 2026, with vector instructions).
constexpr double kTransition_core_s = 7.3e-6;
constexpr double kLong_h = 1;

std::string duration_text(double hours) {
  if (hours < 48) return fmt::format("{:.0f} hours", hours);
  return hours < 2 * 365 * 24 ? fmt::format("{:.0f} days", hours / 24)
                              : fmt::format("{:.0f} years", hours / (365 * 24));
}

/// Expected training time of a network, h; 0 for the SDP.
double training_hours(const TrainOptions& options) {
  if (options.method == Method::kSdp) return 0;
  return kTransition_core_s * static_cast<double>(options.steps) *
         static_cast<double>(options.batch_size) / std::max(1, options.threads) / 3600;
}

}  // namespace

void warn_long_training(const RunConfig& config) {
  const double hours = training_hours(config.train);
  if (hours <= kLong_h) return;
  fmt::print(stderr,
             "bess-train: warning: {} steps of {} transitions take about {} on {} core{}; reduce "
             "[train] steps or batch_size\n",
             config.train.steps, config.train.batch_size, duration_text(hours),
             config.train.threads, config.train.threads == 1 ? "" : "s");
}

void require_plausible(const RunConfig& config, const std::string& name) {
  const BatteryParameters& battery = config.battery;
  if (battery.power_w_max < kPowerMin_w) {
    fail("{}: [battery] power_w = {:g} is below {:g} W; use watts: 5 kW is 5000, 5 MW is 5000000",
         name, battery.power_w_max, kPowerMin_w);
  }
  if (battery.capacity_wh < kCapacityMin_wh) {
    fail(
        "{}: [battery] capacity_wh = {:g} is below {:g} Wh; use watt-hours: 10 MWh is "
        "10000000",
        name, battery.capacity_wh, kCapacityMin_wh);
  }
  const double rate_per_h = battery.power_w_max / battery.capacity_wh;
  if (!(rate_per_h >= kRateMin_per_h && rate_per_h <= kRateMax_per_h)) {
    fail(
        "{}: [battery] power_w = {:g} and capacity_wh = {:g} give a C-rate of {:.2g}/h, outside "
        "{:g} to {:g}/h: is one of them in kW or MW?",
        name, battery.power_w_max, battery.capacity_wh, rate_per_h, kRateMin_per_h, kRateMax_per_h);
  }
  const double round_trip = battery.charge_efficiency * battery.discharge_efficiency;
  if (round_trip < kRoundTripMin || round_trip >= 1) {
    fmt::print(
        stderr,
        "bess-train: warning: {}: [battery] charge_efficiency {:g} times "
        "discharge_efficiency {:g} gives a round-trip efficiency of {:.2f}; usual values are 0.8 "
        "to 0.95\n",
        name, battery.charge_efficiency, battery.discharge_efficiency, round_trip);
  }
}

}  // namespace bess
