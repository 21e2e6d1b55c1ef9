#include "tools/hil_runner/scenario/scenario_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "edge/core/control/control_types.h"
#include "edge/core/control/hold.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {

std::string house_csv(const Scenario& scenario) {
  constexpr int kMinutesAround = 60;
  std::string text = "minute_utc,house_w\n";
  const int end = static_cast<int>(std::ceil(scenario.minutes)) + kMinutesAround;
  for (int minute = -kMinutesAround; minute < end; ++minute) {
    text += fmt::format("{},{}\n", utc_text(scenario.start_utc_s + 60 * minute).view(),
                        step_value_at(scenario.house.steps, minute));
  }
  return text;
}

HouseLoad house_load(const Scenario& scenario) {
  if (scenario.house.seed) return HouseLoad::daily(*scenario.house.seed);
  return HouseLoad::from_csv(house_csv(scenario), scenario.name);
}

namespace {

namespace fs = std::filesystem;

constexpr double kHouseWMax = 1e7;

/// Faults of a meter: on the bus when reading, and of the displayed grid power.
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
  if (ways != 1) table.fail("power_w", "or steps or seed: exactly one is required");
  double power_w = 0;
  read_decimal(table, "power_w", power_w, -kHouseWMax, kHouseWMax);
  if (table.has("power_w")) house.steps = {{.from_min = 0, .value = power_w}};
  read_steps(table, scenario.minutes, house.steps);
  if (table.has("seed")) table.integer("seed", house.seed.emplace(1), 0, INT64_MAX);
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
    if (!meter.variant.empty()) table.fail("variant", "requires a meter with its own map");
    return;
  }
  meter.map = map_path(map, folder, true);
  if (!fs::exists(meter.map))
    table.fail("map", "names no register map: " + meter.map + kMapsOfTheBuild);
}

void read_meter_fault(TomlTable table, Scenario& scenario) {
  ScenarioMeter& meter = scenario.meter;
  if (table.value() == nullptr) return;
  if (meter.source != ScenarioMeter::Source::kMap) {
    table.fail("kinds", meter.source == ScenarioMeter::Source::kNone
                            ? "need [meter]"
                            : "need a meter with its own map; for the grid point of a battery use "
                              "[battery_fault]");
  }
  read_fault_times(table, scenario.minutes, meter.fault);
  read_fault_kinds(table, meter.fault.faults, [](const BatteryFaultInfo& info) -> std::string {
    return is_of_meter(info) ? "" : "is a fault of a battery, not of a meter";
  });
  table.finish();
}

void read_day_ahead(TomlTable table, const fs::path& folder, Scenario& scenario) {
  if (table.value() == nullptr) return;
  AuctionSettings& auction = scenario.day_ahead.emplace();
  auction.start_utc_s = scenario.start_utc_s;
  if (const std::string* const file = table.text("file")) {
    scenario.day_ahead_file = (folder / *file).string();
  }
  int fault = 0;
  table.choice("fault", fault, kAuctionFaultNames);
  auction.fault = static_cast<AuctionFault>(fault);
  for (const char* key : {"every", "from_min", "to_min", "mend_min"}) {
    if (fault == 0 && table.has(key)) table.fail(key, "requires a fault");
  }
  read_fault_span(table, scenario.minutes, auction);
  table.integer("every", auction.every, 1, 1'000'000);
  double mend_min = 0;
  read_decimal(table, "mend_min", mend_min, 0, kScenarioMinutesMax);
  if (table.has("mend_min")) auction.repair_s = 60 * mend_min;
  table.finish();
}

void check_site(TomlTable& root, const Scenario& scenario) {
  using enum ScenarioMeter::Source;
  const bool has_meter = scenario.meter.source != kNone;
  if (has_meter != scenario.house.exists()) {
    return root.fail(has_meter ? "meter" : "house",
                     has_meter ? "needs [house]" : "needs [meter], to be measured");
  }
  if (!scenario.edge_meter.empty() && !has_meter) {
    return root.fail("edge", "meter: needs [meter]");
  }
  for (const char* const table : {"[meter]", "[limits]"}) {
    if (scenario.edge_other.find(table) == std::string::npos) continue;
    return root.fail("edge", fmt::format("other: lines of {} belong to the key {}", table,
                                         table[1] == 'm' ? "meter" : "limits"));
  }
  if (scenario.meter.source != kBattery && scenario.has_grid_fault()) {
    root.fail("battery_fault",
              "kinds: grid-... need [meter] map = \"battery\"; for a meter use [meter_fault]");
  }
}

namespace {

constexpr std::string_view kEventNames[] = {
    "edge_kill",    "edge_stop",       "edge_hand_over", "edge_start",
    "edge_pause",   "edge_continue",   "battery_pause",  "battery_continue",
    "market_pause", "market_continue", "market_kill",    "market_start",
    "clock_step",   "clock_lost",      "clock_back",     "hold",
    "hold_release", "limit",           "limit_clear",    "limit_torn",
    "clear",        "state_lost",      "disk_full"};

/// Duration of a hold or limit, whole seconds.
void read_for_min(TomlTable& table, double minutes_min, std::int64_t& for_s) {
  constexpr double kWeekMin = 7 * 24 * 60;
  double minutes = 0;
  table.require("for_min");
  read_decimal(table, "for_min", minutes, minutes_min, kWeekMin);
  for_s = std::llround(60 * minutes);
}

/// Keys for one kind of event only.
void read_event_values(TomlTable& table, ScenarioEvent& event) {
  using enum ScenarioEvent::EventKind;
  constexpr std::int64_t kPowerWMax = 100'000'000;
  if (event.kind == kClockStep) {
    table.require("seconds");
    read_decimal(table, "seconds", event.seconds, -kSecondsPerDay, kSecondsPerDay);
    if (table.ok() && event.seconds == 0) table.fail("seconds", "must not be 0");
  } else if (event.kind == kHold) {
    table.require("power_w");
    table.integer("power_w", event.power_w, -kPowerWMax, kPowerWMax);
    read_for_min(table, kHoldSecondsMin / 60.0, event.for_s);
  } else if (event.kind == kLimit || event.kind == kLimitTorn) {
    if (!table.has("charge_w") && !table.has("discharge_w")) table.require("charge_w");
    table.integer("charge_w", event.charge_w, 0, kPowerWMax);
    table.integer("discharge_w", event.discharge_w, 0, kPowerWMax);
    read_for_min(table, 0.1, event.for_s);
  }
}

/// Refuses events without effect, such as an end without a begin.
void check_order_of_events(TomlTable& table, const Scenario& scenario) {
  using enum ScenarioEvent::EventKind;
  enum ToggledState : std::uint8_t {
    kEdgeRuns,
    kEdgeStands,
    kBatteryStands,
    kMarketStands,
    kMarketIsDead,
    kClockIsLost,
    kIsHeld,
    kIsLimited,
    kToggledStateCount
  };
  struct StateChange {
    ScenarioEvent::EventKind kind;
    ToggledState state;
    bool becomes;
    const char* already;  ///< reason without effect; null: allowed
  };
  constexpr StateChange kStateChanges[] = {
      {kEdgeKill, kEdgeRuns, false, "the edge does not run"},
      {kEdgeStop, kEdgeRuns, false, "the edge does not run"},
      {kEdgeHandOver, kEdgeRuns, false, "the edge does not run"},
      {kEdgeStart, kEdgeRuns, true, "the edge runs"},
      {kStateLost, kEdgeRuns, true, "the edge runs and uses its state"},
      {kEdgePause, kEdgeStands, true, "the edge is paused"},
      {kEdgeContinue, kEdgeStands, false, "the edge is not paused"},
      {kBatteryPause, kBatteryStands, true, "the battery is paused"},
      {kBatteryContinue, kBatteryStands, false, "the battery is not paused"},
      {kMarketPause, kMarketStands, true, "the market is paused"},
      {kMarketContinue, kMarketStands, false, "the market is not paused"},
      {kMarketKill, kMarketIsDead, true, "the market does not run"},
      {kMarketStart, kMarketIsDead, false, "the market runs"},
      {kClockUnsynchronised, kClockIsLost, true, "the clock is lost"},
      {kClockSynchronised, kClockIsLost, false, "the clock is not lost"},
      {kHold, kIsHeld, true, nullptr},
      {kHoldRelease, kIsHeld, false, "no hold is active"},
      {kLimit, kIsLimited, true, nullptr},
      {kLimitTorn, kIsLimited, true, nullptr},
      {kLimitClear, kIsLimited, false, "no limit is active"}};
  bool is[kToggledStateCount] = {};
  is[kEdgeRuns] = true;
  for (const ScenarioEvent& event : scenario.events) {
    const auto* const change = std::ranges::find(kStateChanges, event.kind, &StateChange::kind);
    if (change == std::end(kStateChanges)) continue;
    if (is[change->state] == change->becomes && change->already != nullptr && table.ok()) {
      table.error() =
          fmt::format("{}:{}: [[event]] {} at minute {:g} has no effect: {}", table.file(),
                      event.line, event_name(event.kind), event.at_min, change->already);
    }
    if (event.kind != kStateLost) is[change->state] = change->becomes;
  }
}

}  // namespace

std::string_view event_name(ScenarioEvent::EventKind kind) {
  return kEventNames[static_cast<std::size_t>(kind)];
}

void read_event(TomlTable table, Scenario& scenario) {
  ScenarioEvent event;
  table.require("at_min");
  read_decimal(table, "at_min", event.at_min, 0, kScenarioMinutesMax);
  if (table.ok() && event.at_min >= scenario.minutes) {
    table.fail("at_min", after_the_end(scenario.minutes));
  }
  if (table.value() != nullptr) event.line = table.value()->line;
  table.require("does");
  const std::string* const kind = table.text("does");
  const auto* const found = std::ranges::find(kEventNames, kind == nullptr ? "" : *kind);
  if (table.ok() && found == std::end(kEventNames)) {
    std::string names;
    for (const std::string_view name : kEventNames) names += ' ' + std::string(name);
    return table.fail("does", "must be one of:" + names);
  }
  event.kind = static_cast<ScenarioEvent::EventKind>(found - std::begin(kEventNames));
  read_event_values(table, event);
  table.finish();
  scenario.events.push_back(event);
}

void check_events(TomlTable& root, const Scenario& scenario) {
  using enum ScenarioEvent::EventKind;
  for (const ScenarioEvent& event : scenario.events) {
    if (std::abs(event.power_w) > scenario.battery.physics.power_w_max) {
      root.fail("event", fmt::format("hold: {} W exceeds the {:g} W of the battery", event.power_w,
                                     scenario.battery.physics.power_w_max));
    }
    const bool of_clock = event.kind == kClockStep || event.kind == kClockUnsynchronised ||
                          event.kind == kClockSynchronised;
    if (of_clock && scenario.runs_wall) {
      root.fail("time", "must be \"virtual\": wall time cannot step the clock");
    }
    if (event.kind == kDiskFull && scenario.runs_virtual) {
      root.fail("time", "must be \"wall\": virtual time has no disk");
    }
  }
  check_order_of_events(root, scenario);
}

namespace {

bool is_reason(std::string_view name) {
  for (int i = 0; i < kReasonCount; ++i) {
    if (reason_name(static_cast<Reason>(i)) == name) return true;
  }
  return false;
}

/// key = [least, most]
void read_range(TomlTable& table, std::string_view key, const char* unit, double& range_min,
                double& range_max) {
  const TomlArray* const range = table.array(key);
  if (range == nullptr) return;
  const auto least = range->size() == 2 ? (*range)[0].number() : std::nullopt;
  const auto most = least ? (*range)[1].number() : std::nullopt;
  if (!most || *least > *most) return table.fail(key, fmt::format("must be [least, most]{}", unit));
  range_min = *least;
  range_max = *most;
}

/// Whether the power range excludes the command.
bool is_ruled_out(const Expectation& e) {
  if (!e.command.direction) return false;
  if (*e.command.direction > 0) return e.power_w_max <= 0;
  if (*e.command.direction < 0) return e.power_w_min >= 0;
  return e.power_w_min > 0 || e.power_w_max < 0;
}

/// Refuses expectations that no run can violate or none can meet.
void check_expectation(TomlTable& table, const Scenario& scenario, const Expectation& e) {
  if (!table.ok()) return;
  constexpr double kStepMin = kSecondsPerStep / 60.0;
  const double first_tick_min = std::ceil(e.span.from_min / kStepMin) * kStepMin;
  if (first_tick_min >= std::min(e.span.to_min, scenario.minutes)) {
    table.fail(table.has("to_min") ? "to_min" : "from_min",
               fmt::format("leaves no tick (every {:g} minutes from 0)", kStepMin));
  }
  const double power_w = scenario.battery.physics.power_w_max;
  if (table.has("power_w") && e.power_w_min <= -power_w && e.power_w_max >= power_w) {
    table.fail("power_w", fmt::format("excludes nothing: the battery has {:g} W", power_w));
  }
  if (e.command.name == "any" && !table.has("power_w") && e.reason.empty() && e.no_reason.empty() &&
      e.outlook == OutlookSource::kNone) {
    table.fail("command", "or power_w, reason, no_reason or outlook is required");
  }
  if (table.has("quarter_hours") && e.outlook == OutlookSource::kNone)
    table.fail("quarter_hours", "requires outlook");
  if (is_ruled_out(e)) table.fail("power_w", "excludes its command");
  if (!e.reason.empty() && e.reason == e.no_reason) table.fail("no_reason", "excludes its reason");
}

}  // namespace

void read_expectation(TomlTable table, Scenario& scenario) {
  Expectation expectation;
  read_span(table, scenario.minutes, expectation.span);
  std::vector<std::string_view> commands;
  for (const ExpectedCommand& known : kExpectedCommands) commands.push_back(known.name);
  int command = 0;
  table.choice("command", command, commands);
  expectation.command = kExpectedCommands[command];
  read_range(table, "power_w", ", in W", expectation.power_w_min, expectation.power_w_max);
  table.choice("outlook", expectation.outlook, {"any", "planned", "usual", "late", "missing"});
  read_range(table, "quarter_hours", "", expectation.quarter_hours_min,
             expectation.quarter_hours_max);
  read_text(table, "reason", expectation.reason);
  read_text(table, "no_reason", expectation.no_reason);
  const std::pair<const char*, const std::string*> reasons[] = {
      {"reason", &expectation.reason}, {"no_reason", &expectation.no_reason}};
  for (const auto& [key, name] : reasons) {
    if (table.ok() && !name->empty() && !is_reason(*name)) {
      table.fail(key, "is not a reason of the guard (see shared/manual/guides/troubleshooting.md)");
    }
  }
  check_expectation(table, scenario, expectation);
  table.finish();
  scenario.expectations.push_back(std::move(expectation));
}

namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t") != std::string::npos) lines.push_back(line);
  }
  return lines;
}

struct Parts {
  const Scenario& scenario;
  std::vector<ScenarioPart> found{};

  /// `take(without)` removes the part from a copy.
  template <typename Take>
  void add(std::string name, const Take& take) {
    found.push_back({.name = std::move(name), .without = scenario});
    take(found.back().without);
  }
  template <typename Take>
  void add_if(bool has, const char* name, const Take& take) {
    if (has) add(name, take);
  }
  /// Each item of a list from `first` on, counted from 1.
  template <typename ListOf>
  void add_each(const char* name, std::size_t first, const ListOf& list_of) {
    Scenario copy = scenario;
    for (std::size_t i = first; i < list_of(copy).size(); ++i) {
      add(fmt::format("{} {}", name, i + 1), [&](Scenario& without) {
        auto& list = list_of(without);
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
      });
    }
  }
  /// Each line of one table for the edge; several tables as one part.
  void add_lines(const char* table, std::string Scenario::*text) {
    const std::vector<std::string> lines = lines_of(scenario.*text);
    const bool are_keys = std::ranges::all_of(lines, [](const std::string& line) {
      return line.find('=') != std::string::npos && line.front() != '[';
    });
    if (!are_keys)
      return add(fmt::format("edge {}", table), [&](Scenario& s) { (s.*text).clear(); });
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string key = lines[i].substr(0, lines[i].find_first_of(" ="));
      add(fmt::format("edge {} {}", table, key), [&](Scenario& without) {
        (without.*text).clear();
        for (std::size_t k = 0; k < lines.size(); ++k) {
          if (k != i) without.*text += lines[k] + "\n";
        }
      });
    }
  }
};

/// The first step is a part only if another step replaces it at the start.
std::size_t first_price_step(const std::vector<ScenarioStep>& steps) {
  return steps.size() > 1 && steps[1].from_min <= 0 ? 0 : 1;
}

}  // namespace

std::vector<ScenarioPart> parts_of(const Scenario& scenario) {
  Parts parts{scenario};
  const Scenario usual;
  const std::string usual_map = map_path(kUsualMap, "");
  parts.add_if(scenario.battery.map != usual_map, "map", [&](Scenario& s) {
    s.battery.map = usual_map;
    s.battery.variant.clear();
  });
  parts.add_if(scenario.battery.map == usual_map && !scenario.battery.variant.empty(), "variant",
               [](Scenario& s) { s.battery.variant.clear(); });
  parts.add_if(scenario.battery.rtu, "transport", [](Scenario& s) { s.battery.rtu = false; });
  if (scenario.battery_faults.size() > 1) {
    parts.add_each(
        "battery_fault", 0, [](Scenario & s) -> auto& { return s.battery_faults; });
  } else {
    parts.add_if(!scenario.battery_faults.empty(), "battery_fault",
                 [](Scenario& s) { s.battery_faults.clear(); });
  }
  parts.add_if(!scenario.meter.fault.faults.empty(), "meter_fault",
               [](Scenario& s) { s.meter.fault = {}; });
  parts.add_if(scenario.price_fault.fault != MarketFault::kNone, "price_fault",
               [](Scenario& s) { s.price_fault.fault = MarketFault::kNone; });
  parts.add_if(scenario.day_ahead && scenario.day_ahead->fault != AuctionFault::kNone,
               "day_ahead fault", [](Scenario& s) { s.day_ahead->fault = AuctionFault::kNone; });
  parts.add_each(
      "event", 0, [](Scenario & s) -> auto& { return s.events; });
  parts.add_each(
      "missing", 0, [](Scenario & s) -> auto& { return s.prices.missing; });
  parts.add_each(
      "price step", first_price_step(scenario.prices.steps),
      [](Scenario & s) -> auto& { return s.prices.steps; });
  parts.add_if(scenario.prices.latency_s != usual.prices.latency_s, "latency_s",
               [&](Scenario& s) { s.prices.latency_s = usual.prices.latency_s; });
  parts.add_each(
      "house step", 1, [](Scenario & s) -> auto& { return s.house.steps; });
  parts.add_lines("battery", &Scenario::edge_battery);
  parts.add_lines("price", &Scenario::edge_price);
  parts.add_lines("guard", &Scenario::edge_guard);
  parts.add_lines("meter", &Scenario::edge_meter);
  parts.add_lines("limits", &Scenario::edge_limits);
  parts.add_lines("other", &Scenario::edge_other);
  return std::move(parts.found);
}

}  // namespace bess
