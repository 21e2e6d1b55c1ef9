#include "tools/hil_runner/scenario/scenario_site.h"

#include <algorithm>
#include <filesystem>

#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr double kHouseWMax = 1e7;

/// What a meter can do wrong: on the bus, as long as it is read, and in what it shows of the grid.
bool is_of_meter(const BatteryFaultInfo& info) {
  using enum BatteryFault;
  const bool is_read = (info.chances & ~static_cast<unsigned>(FaultChance::kWrite)) != 0;
  const bool is_of_bus = info.fault <= kBadCrc && info.tcp && is_read;
  return is_of_bus || is_of_grid(info.fault) || info.fault == kFrozen || info.fault == kWrongSign;
}

}  // namespace

void read_house(TomlTable table, Scenario& scenario) {
  ScenarioHouse& house = scenario.house;
  if (table.value() == nullptr) return;
  const int ways = int{table.has("power_w")} + int{table.has("steps")} + int{table.has("seed")};
  if (ways != 1) table.fail("power_w", "or steps or seed: exactly one of them is needed");
  double power_w = 0;
  read_decimal(table, "power_w", power_w, -kHouseWMax, kHouseWMax);
  if (table.has("power_w")) house.steps = {{.from_min = 0, .power_w = power_w}};
  read_steps(table, scenario.minutes, house.steps, [](double from_min, double step_w) {
    return ScenarioHouse::Step{.from_min = from_min, .power_w = step_w};
  });
  if (table.has("seed")) {
    std::int64_t seed = 1;
    table.integer("seed", seed, 0, INT64_MAX);
    house.seed = static_cast<std::uint64_t>(seed);
  }
  table.finish();
}

void read_meter(TomlTable table, const fs::path& folder, ScenarioMeter& meter) {
  if (table.value() == nullptr) return;
  std::string map;
  table.require("map");
  read_text(table, "map", map);
  read_text(table, "variant", meter.variant);
  table.finish();
  if (!table.ok()) return;
  meter.source = map == "battery" ? ScenarioMeter::Source::kBattery : ScenarioMeter::Source::kMap;
  if (meter.source == ScenarioMeter::Source::kBattery) {
    if (!meter.variant.empty()) table.fail("variant", "is of a meter with a map of its own");
    return;
  }
  const bool is_name = map.find('/') == std::string::npos && !map.ends_with(".toml");
  meter.map = is_name ? std::string(BESS_METER_DIR) + "/" + map + ".toml"
                      : (folder / map).lexically_normal().string();
  if (!fs::exists(meter.map)) table.fail("map", "names no register map: " + meter.map);
}

void read_meter_fault(TomlTable table, Scenario& scenario) {
  ScenarioMeter& meter = scenario.meter;
  if (table.value() == nullptr) return;
  if (meter.source != ScenarioMeter::Source::kMap) {
    table.fail("kinds", meter.source == ScenarioMeter::Source::kNone
                            ? "need [meter], which is to be wrong"
                            : "are of a meter's own map: a battery's grid point is wrong by "
                              "[battery_fault]");
  }
  MinuteSpan window;
  read_span(table, scenario.minutes, window);
  FaultSchedule& schedule = meter.fault.schedule;
  schedule.every = 1;
  schedule.from_s = 60 * window.from_min;
  schedule.to_s = 60 * window.to_min;
  read_decimal(table, "on_s", schedule.on_s, 1, 86'400);
  read_decimal(table, "off_s", schedule.off_s, 1, 86'400);
  if (table.ok() && (schedule.on_s > 0) != (schedule.off_s > 0)) {
    table.fail(schedule.on_s > 0 ? "on_s" : "off_s", "comes with the other of on_s and off_s");
  }
  read_fault_kinds(table, schedule.faults, [](const BatteryFaultInfo& info) -> std::string {
    return is_of_meter(info) ? "" : "is of a battery, not of a meter";
  });
  table.finish();
}

void check_site(TomlTable& root, const Scenario& scenario) {
  using enum ScenarioMeter::Source;
  const bool has_meter = scenario.meter.source != kNone;
  if (has_meter != scenario.house.exists()) {
    return root.fail(has_meter ? "meter" : "house",
                     has_meter ? "needs [house], whose load it shows"
                               : "needs [meter]: else nobody would see it");
  }
  if (!scenario.edge_meter.empty() && !has_meter) {
    return root.fail("edge", "meter: needs [meter], which is read");
  }
  for (const char* const table : {"[meter]", "[limits]"}) {
    if (scenario.edge_other.find(table) == std::string::npos) continue;
    return root.fail("edge", fmt::format("other: lines of {} go into the key {}", table,
                                         table[1] == 'm' ? "meter" : "limits"));
  }
  if (scenario.meter.source != kBattery && scenario.has_battery_fault(is_of_grid)) {
    root.fail("battery_fault",
              "kinds: grid-... need [meter] map = \"battery\"; a meter's own are [meter_fault]");
  }
}

}  // namespace bess
