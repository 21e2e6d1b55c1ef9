#include "tools/hil_runner/scenario.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "edge/control/control_types.h"
#include "shared/host/toml_document.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/invariants.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr double kMinutesMax = 60.0 * 24 * 400;
constexpr double kWallMinutesMax = 180;

constexpr std::string_view kEventNames[] = {
    "edge_kill",    "edge_stop",       "edge_hand_over", "edge_start",
    "edge_pause",   "edge_continue",   "battery_pause",  "battery_continue",
    "market_pause", "market_continue", "market_kill",    "market_start",
    "clock_step",   "clock_lost",      "clock_back",     "disk_full"};

void decimal(TomlTable& table, std::string_view key, double& value, double min, double max) {
  const TomlValue* const node = table.node(key);
  if (node == nullptr) return;
  const auto number = node->number();
  if (!number || !(*number >= min && *number <= max)) {
    return table.fail(key, fmt::format("must be a number from {:g} to {:g}", min, max));
  }
  value = *number;
}

void span(TomlTable& table, MinuteSpan& span) {
  decimal(table, "from_min", span.from_min, 0, kMinutesMax);
  decimal(table, "to_min", span.to_min, 0, kMinutesMax);
  if (table.ok() && span.to_min <= span.from_min) {
    table.fail("to_min", "must be later than from_min");
  }
}

void assign(TomlTable& table, std::string_view key, std::string& value) {
  if (const std::string* const text = table.text(key)) value = *text;
}

/// Calls `take(first, second)` for each pair of numbers in a list of pairs.
template <typename Take>
void pairs(TomlTable& table, std::string_view key, const Take& take) {
  const TomlArray* const list = table.array(key);
  if (list == nullptr) return;
  for (const TomlValue& item : *list) {
    const auto* const pair = item.as<TomlArray>();
    const auto first = pair != nullptr && pair->size() == 2 ? (*pair)[0].number() : std::nullopt;
    const auto second = first ? (*pair)[1].number() : std::nullopt;
    if (!second)
      return table.fail_at(item, std::string(key) + " must be a list of pairs of numbers");
    take(*first, *second);
  }
}

void read_battery(TomlTable table, const fs::path& folder, ScenarioBattery& battery) {
  std::string map = "alphaess";
  assign(table, "map", map);
  battery.names_map = table.has("map");
  for (const char* key : {"soc", "power_w", "capacity_wh", "soc_floor", "soc_ceiling"}) {
    battery.sets_state = battery.sets_state || table.has(key);
  }
  battery.map = map_path(map, folder);
  if (table.ok() && !fs::exists(battery.map)) {
    table.fail("map", "names no register map: " + battery.map);
  }
  assign(table, "variant", battery.variant);
  int transport = 0;
  table.choice("transport", transport, {"tcp", "rtu"});
  battery.rtu = transport == 1;
  decimal(table, "soc", battery.soc_frac, 0, 1);
  decimal(table, "power_w", battery.physics.power_w_max, 1, 1e8);
  decimal(table, "capacity_wh", battery.physics.capacity_wh, 1, 1e9);
  decimal(table, "soc_floor", battery.physics.soc_min_frac, 0, 1);
  decimal(table, "soc_ceiling", battery.physics.soc_max_frac, 0, 1);
  table.integer("response_delay_ms", battery.response_delay_ms, 0, 60'000);
  if (table.ok() && battery.physics.soc_min_frac >= battery.physics.soc_max_frac) {
    table.fail("soc_floor", "must be below soc_ceiling");
  }
  table.finish();
}

void read_prices(TomlTable table, const fs::path& folder, ScenarioPrices& prices) {
  assign(table, "file", prices.file);
  if (!prices.file.empty()) prices.file = (folder / prices.file).lexically_normal().string();
  pairs(table, "steps", [&](double minute, double price) {
    prices.steps.push_back({minute, price});
  });
  if (const TomlValue* const node = table.table("wave")) {
    TomlTable wave(node, table.file(), "[prices] wave", table.error());
    decimal(wave, "mean", prices.wave_mean_eur_per_mwh, -kPlausiblePriceMaxEurPerMwh,
            kPlausiblePriceMaxEurPerMwh);
    decimal(wave, "amplitude", prices.wave_amplitude_eur_per_mwh, 0, kPlausiblePriceMaxEurPerMwh);
    decimal(wave, "period_min", prices.wave_period_min, 2, kMinutesMax);
    wave.finish();
  }
  decimal(table, "latency_s", prices.latency_s, 0, 3'600);
  pairs(table, "missing", [&](double from, double to) {
    prices.missing.push_back({.from_min = from, .to_min = to});
  });
  if (table.ok() && !std::ranges::is_sorted(prices.steps, {}, &ScenarioPrices::Step::from_min)) {
    table.fail("steps", "must be in the order of time");
  }
  table.finish();
}

void read_battery_fault(TomlTable table, bool rtu, BatteryFaultWindow& fault) {
  if (table.value() == nullptr) return;
  MinuteSpan window;
  span(table, window);
  fault.schedule.every = 1;
  fault.schedule.from_s = 60 * window.from_min;
  fault.schedule.to_s = 60 * window.to_min;
  table.integer("every", fault.schedule.every, 1, 1'000'000);
  decimal(table, "probability", fault.schedule.probability, 0, 1);
  decimal(table, "on_s", fault.schedule.on_s, 1, 86'400);
  decimal(table, "off_s", fault.schedule.off_s, 1, 86'400);
  if (table.ok() && (fault.schedule.on_s > 0) != (fault.schedule.off_s > 0)) {
    table.fail(fault.schedule.on_s > 0 ? "on_s" : "off_s",
               "comes with the other of on_s and off_s");
  }
  std::int64_t seed = 1;
  table.integer("seed", seed, 0, INT64_MAX);
  fault.schedule.seed = static_cast<std::uint64_t>(seed);
  table.integer("period_s", fault.schedule.period_s, 1, 86'400);
  table.integer("late_ms", fault.late_ms, 1, 60'000);
  table.integer("drip_ms", fault.drip_ms, 1, 60'000);
  table.integer("exception_code", fault.exception_code, 1, 255);
  table.require("kinds");
  const TomlArray* const kinds = table.array("kinds");
  for (std::size_t i = 0; kinds != nullptr && i < kinds->size(); ++i) {
    const auto* const name = (*kinds)[i].as<std::string>();
    const auto found = std::ranges::find_if(battery_faults(), [&](const BatteryFaultInfo& info) {
      return name != nullptr && *name == info.name;
    });
    if (found == battery_faults().end()) {
      table.fail_at((*kinds)[i], "no fault of the battery (see bess-sim battery --help)");
    } else if (!(rtu ? found->rtu : found->tcp)) {
      table.fail_at((*kinds)[i], rtu ? "only without a serial line" : "only on a serial line");
    } else {
      fault.schedule.faults.push_back(found->fault);
    }
  }
  table.finish();
}

void read_price_fault(TomlTable table, PriceFaultWindow& fault) {
  if (table.value() == nullptr) return;
  span(table, fault.span);
  table.integer("every", fault.every, 1, 1'000'000);
  int kind = 0;
  table.require("kind");
  table.choice("kind", kind, {"null", "http-500", "stale", "garbage", "trailing", "twice", "all"});
  constexpr MarketFault kKinds[] = {
      MarketFault::kNull,     MarketFault::kHttp500, MarketFault::kStale, MarketFault::kGarbage,
      MarketFault::kTrailing, MarketFault::kTwice,   MarketFault::kAll};
  fault.fault = kKinds[kind];
  table.finish();
}

void read_event(TomlTable table, Scenario& scenario) {
  ScenarioEvent event;
  table.require("at_min");
  decimal(table, "at_min", event.at_min, 0, kMinutesMax);
  table.require("does");
  const std::string* const does = table.text("does");
  const auto* const found = std::ranges::find(kEventNames, does == nullptr ? "" : *does);
  if (table.ok() && found == std::end(kEventNames)) {
    std::string names;
    for (const std::string_view name : kEventNames) names += ' ' + std::string(name);
    return table.fail("does", "must be one of:" + names);
  }
  event.does = static_cast<ScenarioEvent::Does>(found - std::begin(kEventNames));
  decimal(table, "seconds", event.seconds, -86'400, 86'400);
  table.finish();
  scenario.events.push_back(event);
}

bool is_reason(std::string_view name) {
  for (int i = 0; i < kReasonCount; ++i) {
    if (reason_name(static_cast<Reason>(i)) == name) return true;
  }
  return false;
}

void read_expectation(TomlTable table, Scenario& scenario) {
  Expectation expectation;
  span(table, expectation.span);
  int command = 0;
  table.choice("command", command,
               {"any", "charge", "discharge", "zero", "none", "driven", "not_driven"});
  expectation.command = static_cast<Expectation::Command>(command);
  assign(table, "reason", expectation.reason);
  assign(table, "no_reason", expectation.no_reason);
  const std::pair<const char*, const std::string*> reasons[] = {
      {"reason", &expectation.reason}, {"no_reason", &expectation.no_reason}};
  for (const auto& [key, name] : reasons) {
    if (table.ok() && !name->empty() && !is_reason(*name)) {
      table.fail(key, "is no reason of the guard (edge/README.md lists them)");
    }
  }
  table.finish();
  scenario.expectations.push_back(std::move(expectation));
}

void read_judge(TomlTable table, Scenario& scenario) {
  for (const InvariantInfo& info : invariants()) scenario.invariants.emplace_back(info.name);
  const auto known = [&](const TomlValue& item) {
    const auto* const name = item.as<std::string>();
    return name == nullptr ? scenario.invariants.end()
                           : std::ranges::find(scenario.invariants, *name);
  };
  if (const TomlArray* const list = table.array("all_but")) {
    for (const TomlValue& item : *list) {
      const auto found = known(item);
      if (found == scenario.invariants.end()) {
        table.fail_at(item, "no invariant (bess-hil --invariants lists them)");
      } else {
        scenario.invariants.erase(found);
      }
    }
  }
  decimal(table, "recovery_min", scenario.recovery_min, 0, kMinutesMax);
  table.integer("exit_code", scenario.exit_code, 0, 255);
  table.finish();
}

void read_edge(TomlTable table, Scenario& scenario) {
  assign(table, "battery", scenario.edge_battery);
  assign(table, "price", scenario.edge_price);
  assign(table, "guard", scenario.edge_guard);
  assign(table, "other", scenario.edge_other);
  table.finish();
}

void read_time(TomlTable& table, Scenario& scenario) {
  std::string start = "2023-03-26T00:00:00Z";
  assign(table, "start_utc", start);
  if (table.ok() &&
      (!parse_utc(start, scenario.start_utc_s) || scenario.start_utc_s % kSecondsPerStep != 0)) {
    table.fail("start_utc",
               "must be a UTC instant at an even minute, such as 2023-03-26T00:00:00Z");
  }
  decimal(table, "minutes", scenario.minutes, 4, kMinutesMax);
  table.integer("time_scale", scenario.time_scale, 1, 900);
  int time = 0;
  table.choice("time", time, {"both", "virtual", "wall"});
  scenario.runs_virtual = time != 2;
  scenario.runs_wall = time != 1;
  if (table.ok() && scenario.runs_wall && scenario.minutes > kWallMinutesMax) {
    table.fail("minutes",
               fmt::format("over {:g} is for time = \"virtual\" alone", kWallMinutesMax));
  }
}

/// What begins after the end would never be, and the scenario would pass without it.
void check_beginnings(TomlTable& table, const Scenario& scenario) {
  const auto begins = [&](const char* where, double minute) {
    if (!table.error().empty() || minute < scenario.minutes) return;
    table.error() = fmt::format("{}: {} begins at minute {:g}, after the end of {:g} minutes",
                                scenario.path, where, minute, scenario.minutes);
  };
  for (const ScenarioEvent& event : scenario.events) begins("[[event]]", event.at_min);
  for (const Expectation& e : scenario.expectations) begins("[[expect]]", e.span.from_min);
  begins("[battery_fault]", scenario.battery_fault.schedule.from_s / 60);
  begins("[price_fault]", scenario.price_fault.span.from_min);
  for (const MinuteSpan& gap : scenario.prices.missing) begins("[prices] missing", gap.from_min);
}

/// What only one of the two times can do.
void check_events(TomlTable& table, const Scenario& scenario) {
  using enum ScenarioEvent::Does;
  for (const ScenarioEvent& event : scenario.events) {
    const bool of_clock = event.does == kClockStep || event.does == kClockUnsynchronised ||
                          event.does == kClockSynchronised;
    if (of_clock && scenario.runs_wall) {
      table.fail("time", "must be \"virtual\": the clock of this machine is not stepped");
    }
    if (event.does == kDiskFull && scenario.runs_virtual) {
      table.fail("time", "must be \"wall\": in virtual time there is no disk");
    }
  }
}

template <typename Read>
void each(TomlTable& table, std::string_view key, const Read& read) {
  const TomlArray* const list = table.array(key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    read(TomlTable(&(*list)[i], table.file(), "[[" + std::string(key) + "]]", table.error()));
  }
}

}  // namespace

std::string map_path(const std::string& name, const fs::path& folder) {
  if (name.find('/') == std::string::npos && !name.ends_with(".toml")) {
    return std::string(BESS_MAP_DIR) + "/" + name + ".toml";
  }
  return (folder / name).lexically_normal().string();
}

std::string_view event_name(ScenarioEvent::Does does) {
  return kEventNames[static_cast<std::size_t>(does)];
}

std::int64_t Scenario::utc_ns_at(double minute) const {
  return start_utc_s * kNanosecondsPerSecond + std::llround(minute * 60e9);
}

Scenario read_scenario(const std::string& path) {
  TomlValue document;
  std::string error;
  if (!parse_toml_file(path, document, error)) throw UserError(error);
  Scenario scenario;
  scenario.name = fs::path(path).stem().string();
  scenario.path = path;
  const fs::path folder = fs::path(path).parent_path();
  TomlTable table(&document, path, "", error);
  const auto sub = [&](const char* key) {
    return TomlTable(table.table(key), path, "[" + std::string(key) + "]", error);
  };
  table.require("title");
  assign(table, "title", scenario.title);
  read_time(table, scenario);
  read_battery(sub("battery"), folder, scenario.battery);
  read_prices(sub("prices"), folder, scenario.prices);
  read_battery_fault(sub("battery_fault"), scenario.battery.rtu, scenario.battery_fault);
  read_price_fault(sub("price_fault"), scenario.price_fault);
  each(table, "event", [&](TomlTable event) { read_event(std::move(event), scenario); });
  each(table, "expect", [&](TomlTable expect) { read_expectation(std::move(expect), scenario); });
  read_edge(sub("edge"), scenario);
  read_judge(sub("judge"), scenario);
  check_events(table, scenario);
  check_beginnings(table, scenario);
  table.finish();
  if (!error.empty()) throw UserError(error);
  std::ranges::stable_sort(scenario.events, {}, &ScenarioEvent::at_min);
  return scenario;
}

}  // namespace bess
