#include "tools/hil_runner/wall/simulator_options.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "tools/hil_runner/scenario/day_ahead.h"
#include "tools/hil_runner/scenario/scenario_parts.h"

namespace bess {
namespace {

/// A command line that grows.
class Options {
 public:
  template <typename Value>
  void add(const std::string& name, const Value& value) {
    words_.insert(words_.end(), {name, fmt::format("{}", value)});
  }
  /// Until the end: nothing.
  void add_span(const std::string& prefix, double from_s, double to_s) {
    add(prefix + "-from-s", from_s);
    if (to_s != kNeverMin) add(prefix + "-to-s", to_s);
  }
  /// What strikes, from when to when, and whether it comes and goes.
  void add_faults(const std::string& prefix, const FaultSchedule& schedule) {
    for (const BatteryFault kind : schedule.faults) {
      add(prefix, battery_faults()[static_cast<std::size_t>(kind) - 1].name);
    }
    add_span(prefix, schedule.from_s, schedule.to_s);
    if (schedule.off_s == 0) return;
    add(prefix + "-on-s", schedule.on_s);
    add(prefix + "-off-s", schedule.off_s);
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(words_); }

 private:
  std::vector<std::string> words_;
};

void add_plant(Options& options, const ScenarioBattery& battery) {
  options.add("--map", battery.map);
  if (!battery.variant.empty()) options.add("--variant", battery.variant);
  options.add("--soc", battery.soc_frac);
  options.add("--power-w", battery.physics.power_w_max);
  options.add("--capacity-wh", battery.physics.capacity_wh);
  options.add("--soc-min", battery.physics.soc_min_frac);
  options.add("--soc-max", battery.physics.soc_max_frac);
}

void add_battery_faults(Options& options, const BatteryFaultWindow& fault) {
  const FaultSchedule& schedule = fault.schedule;
  if (schedule.faults.empty()) return;
  options.add_faults("--fault", schedule);
  if (schedule.probability > 0) {
    options.add("--fault-probability", schedule.probability);
  } else {
    options.add("--fault-every", schedule.every);
  }
  options.add("--fault-seed", schedule.seed);
  options.add("--fault-period-s", schedule.period_s);
  options.add("--late-ms", fault.late_ms);
  options.add("--drip-ms", fault.drip_ms);
  options.add("--exception-code", fault.exception_code);
}

void add_house(Options& options, const Scenario& scenario, const WorkFolder& folder) {
  if (!scenario.house.exists()) return;
  if (scenario.house.seed) {
    options.add("--house", "daily");
    return options.add("--house-seed", *scenario.house.seed);
  }
  write_file(folder.file("house.csv"), house_csv(scenario));
  options.add("--house", folder.file("house.csv"));
}

void add_meter(Options& options, const ScenarioMeter& meter) {
  if (meter.source != ScenarioMeter::Source::kMap) return;
  options.add("--meter-map", meter.map);
  if (!meter.variant.empty()) options.add("--meter-variant", meter.variant);
  options.add("--meter-port", 0);
  if (!meter.fault.schedule.faults.empty()) {
    options.add_faults("--meter-fault", meter.fault.schedule);
  }
}

void add_day_ahead(Options& options, const Scenario& scenario, const WorkFolder& folder) {
  if (!scenario.day_ahead) return;
  write_file(folder.file("day_ahead.csv"), day_ahead_csv(scenario));
  options.add("--day-ahead", folder.file("day_ahead.csv"));
  const AuctionSettings& auction = *scenario.day_ahead;
  if (auction.fault == AuctionFault::kNone) return;
  options.add("--day-ahead-fault", kAuctionFaultNames[static_cast<int>(auction.fault)]);
  options.add("--day-ahead-fault-every", auction.every);
  options.add_span("--day-ahead-fault", auction.from_s, auction.to_s);
  if (auction.mend_s) options.add("--day-ahead-mend-s", *auction.mend_s);
}

}  // namespace

std::vector<std::string> battery_options(const Scenario& scenario, const std::string& serial_device,
                                         const WorkFolder& folder) {
  Options options;
  add_plant(options, scenario.battery);
  if (!serial_device.empty()) {
    options.add("--serial", serial_device);
    options.add("--baud", 115'200);
  }
  for (const BatteryFaultWindow& fault : scenario.battery_faults) {
    add_battery_faults(options, fault);  // one: the reader has refused more
  }
  add_house(options, scenario, folder);
  add_meter(options, scenario.meter);
  return options.take();
}

std::vector<std::string> market_options(const Scenario& scenario, const std::string& prices,
                                        const WorkFolder& folder) {
  const PriceFaultWindow& fault = scenario.price_fault;
  Options options;
  options.add("--prices", prices);
  options.add("--latency-s", scenario.prices.latency_s);
  add_day_ahead(options, scenario, folder);
  if (fault.fault == MarketFault::kNone) return options.take();
  options.add("--fault", kMarketFaultNames[static_cast<int>(fault.fault)]);
  options.add("--fault-every", fault.every);
  options.add_span("--fault", 60 * fault.span.from_min, 60 * fault.span.to_min);
  return options.take();
}

}  // namespace bess
