#include "tools/hil_runner/scenario/scenario.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "edge/control/control_types.h"
#include "edge/control/hold.h"
#include "edge/control/price_history.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/hil_runner/scenario/scenario_reader.h"
#include "tools/hil_runner/scenario/scenario_site.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr double kWallMinutesMax = 180;

constexpr std::string_view kEventNames[] = {
    "edge_kill",    "edge_stop",       "edge_hand_over", "edge_start",
    "edge_pause",   "edge_continue",   "battery_pause",  "battery_continue",
    "market_pause", "market_continue", "market_kill",    "market_start",
    "clock_step",   "clock_lost",      "clock_back",     "hold",
    "hold_release", "limit",           "limit_clear",    "limit_torn",
    "clear",        "disk_full"};

void read_battery(TomlTable table, const fs::path& folder, ScenarioBattery& battery) {
  std::string map = "alphaess";
  read_text(table, "map", map);
  battery.names_map = table.has("map");
  for (const char* key : {"soc", "power_w", "capacity_wh", "soc_floor", "soc_ceiling"}) {
    battery.sets_state = battery.sets_state || table.has(key);
  }
  battery.map = map_path(map, folder);
  if (table.ok() && !fs::exists(battery.map)) {
    table.fail("map", "names no register map: " + battery.map);
  }
  read_text(table, "variant", battery.variant);
  int transport = 0;
  table.choice("transport", transport, {"tcp", "rtu"});
  battery.rtu = transport == 1;
  read_decimal(table, "soc", battery.soc_frac, 0, 1);
  read_decimal(table, "power_w", battery.physics.power_w_max, 1, 1e8);
  read_decimal(table, "capacity_wh", battery.physics.capacity_wh, 1, 1e9);
  read_decimal(table, "soc_floor", battery.physics.soc_min_frac, 0, 1);
  read_decimal(table, "soc_ceiling", battery.physics.soc_max_frac, 0, 1);
  table.integer("response_delay_ms", battery.response_delay_ms, 0, 60'000);
  if (table.ok() && battery.physics.soc_min_frac >= battery.physics.soc_max_frac) {
    table.fail("soc_floor", "must be below soc_ceiling");
  }
  table.finish();
}

void read_prices(TomlTable table, const fs::path& folder, ScenarioPrices& prices) {
  read_text(table, "file", prices.file);
  if (!prices.file.empty()) prices.file = (folder / prices.file).lexically_normal().string();
  read_pairs(table, "steps", [&](double minute, double price) {
    prices.steps.push_back({minute, price});
  });
  if (const TomlValue* const node = table.table("wave")) {
    TomlTable wave(node, table.file(), "[prices] wave", table.error());
    read_decimal(wave, "mean", prices.wave_mean_eur_per_mwh, -kPlausiblePriceMaxEurPerMwh,
                 kPlausiblePriceMaxEurPerMwh);
    read_decimal(wave, "amplitude", prices.wave_amplitude_eur_per_mwh, 0,
                 kPlausiblePriceMaxEurPerMwh);
    read_decimal(wave, "period_min", prices.wave_period_min, 2, kScenarioMinutesMax);
    wave.finish();
  }
  read_decimal(table, "latency_s", prices.latency_s, 0, 3'600);
  table.integer("history_hours", prices.history_hours, 1, PriceHistory::kHoursMax);
  read_pairs(table, "missing", [&](double from, double to) {
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
  read_span(table, window);
  fault.schedule.every = 1;
  fault.schedule.from_s = 60 * window.from_min;
  fault.schedule.to_s = 60 * window.to_min;
  table.integer("every", fault.schedule.every, 1, 1'000'000);
  read_decimal(table, "probability", fault.schedule.probability, 0, 1);
  read_decimal(table, "on_s", fault.schedule.on_s, 1, 86'400);
  read_decimal(table, "off_s", fault.schedule.off_s, 1, 86'400);
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
  read_fault_kinds(table, fault.schedule.faults, [rtu](const BatteryFaultInfo& info) {
    if (rtu ? info.rtu : info.tcp) return std::string();
    return std::string(rtu ? "only without a serial line" : "only on a serial line");
  });
  table.finish();
}

void read_price_fault(TomlTable table, PriceFaultWindow& fault) {
  if (table.value() == nullptr) return;
  read_span(table, fault.span);
  table.integer("every", fault.every, 1, 1'000'000);
  int kind = 0;
  table.require("kind");
  table.choice("kind", kind,
               {"null", "http-500", "stale", "garbage", "trailing", "twice", "all", "frozen"});
  fault.fault = static_cast<MarketFault>(kind + 1);
  // What it would show once it moves again, or in some of its answers, steps of [prices] show.
  const bool is_partly_frozen = fault.every > 1 || fault.span.to_min != kNeverMin;
  if (table.ok() && fault.fault == MarketFault::kFrozen && is_partly_frozen) {
    table.fail("kind", "frozen lasts to the end, in every answer: leave every and to_min out");
  }
  table.finish();
}

/// How long it holds, in whole seconds, as the command lines take it.
void read_for_min(TomlTable& table, double minutes_min, std::int64_t& for_s) {
  constexpr double kWeekMin = 7 * 24 * 60;
  double minutes = 0;
  table.require("for_min");
  read_decimal(table, "for_min", minutes, minutes_min, kWeekMin);
  for_s = std::llround(60 * minutes);
}

/// What belongs to one kind of event alone.
void read_what_is_said(TomlTable& table, ScenarioEvent& event) {
  using enum ScenarioEvent::Does;
  constexpr std::int64_t kPowerWMax = 100'000'000;
  if (event.does == kClockStep) {
    read_decimal(table, "seconds", event.seconds, -86'400, 86'400);
  } else if (event.does == kHold) {
    table.require("power_w");
    table.integer("power_w", event.power_w, -kPowerWMax, kPowerWMax);
    read_for_min(table, kHoldSecondsMin / 60.0, event.for_s);
  } else if (event.does == kLimit || event.does == kLimitTorn) {
    if (!table.has("charge_w") && !table.has("discharge_w")) table.require("charge_w");
    table.integer("charge_w", event.charge_w, 0, kPowerWMax);
    table.integer("discharge_w", event.discharge_w, 0, kPowerWMax);
    read_for_min(table, 0.1, event.for_s);
  }
}

void read_event(TomlTable table, Scenario& scenario) {
  ScenarioEvent event;
  table.require("at_min");
  read_decimal(table, "at_min", event.at_min, 0, kScenarioMinutesMax);
  table.require("does");
  const std::string* const does = table.text("does");
  const auto* const found = std::ranges::find(kEventNames, does == nullptr ? "" : *does);
  if (table.ok() && found == std::end(kEventNames)) {
    std::string names;
    for (const std::string_view name : kEventNames) names += ' ' + std::string(name);
    return table.fail("does", "must be one of:" + names);
  }
  event.does = static_cast<ScenarioEvent::Does>(found - std::begin(kEventNames));
  read_what_is_said(table, event);
  table.finish();
  scenario.events.push_back(event);
}

bool is_reason(std::string_view name) {
  for (int i = 0; i < kReasonCount; ++i) {
    if (reason_name(static_cast<Reason>(i)) == name) return true;
  }
  return false;
}

/// power_w = [least, most]
void read_expected_power(TomlTable& table, Expectation& expectation) {
  const TomlArray* const range = table.array("power_w");
  if (range == nullptr) return;
  const auto least = range->size() == 2 ? (*range)[0].number() : std::nullopt;
  const auto most = least ? (*range)[1].number() : std::nullopt;
  if (!most || *least > *most) return table.fail("power_w", "must be [least, most], in W");
  expectation.power_w_min = *least;
  expectation.power_w_max = *most;
}

void read_expectation(TomlTable table, Scenario& scenario) {
  Expectation expectation;
  read_span(table, expectation.span);
  int command = 0;
  table.choice("command", command,
               {"any", "charge", "discharge", "zero", "none", "driven", "not_driven"});
  expectation.command = static_cast<Expectation::Command>(command);
  read_expected_power(table, expectation);
  read_text(table, "reason", expectation.reason);
  read_text(table, "no_reason", expectation.no_reason);
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
  for (const RuleInfo& info : kRuleInfos) scenario.invariants.emplace_back(info.name);
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
  read_decimal(table, "recovery_min", scenario.recovery_min, 0, kScenarioMinutesMax);
  table.integer("exit_code", scenario.exit_code, 0, 255);
  table.finish();
}

void read_edge(TomlTable table, Scenario& scenario) {
  read_text(table, "battery", scenario.edge_battery);
  read_text(table, "price", scenario.edge_price);
  read_text(table, "guard", scenario.edge_guard);
  read_text(table, "meter", scenario.edge_meter);
  read_text(table, "limits", scenario.edge_limits);
  read_text(table, "other", scenario.edge_other);
  table.finish();
}

void read_time(TomlTable& table, Scenario& scenario) {
  std::string start = "2023-03-26T00:00:00Z";
  read_text(table, "start_utc", start);
  if (table.ok() &&
      (!parse_utc(start, scenario.start_utc_s) || scenario.start_utc_s % kSecondsPerStep != 0)) {
    table.fail("start_utc",
               "must be a UTC instant at an even minute, such as 2023-03-26T00:00:00Z");
  }
  read_decimal(table, "minutes", scenario.minutes, 4, kScenarioMinutesMax);
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
  begins("[meter_fault]", scenario.meter.fault.schedule.from_s / 60);
  begins("[price_fault]", scenario.price_fault.span.from_min);
  for (const ScenarioHouse::Step& step : scenario.house.steps) begins("[house]", step.from_min);
  for (const MinuteSpan& gap : scenario.prices.missing) begins("[prices] missing", gap.from_min);
}

/// What only one of the two times can do, and what the edge would refuse.
void check_events(TomlTable& table, const Scenario& scenario) {
  using enum ScenarioEvent::Does;
  for (const ScenarioEvent& event : scenario.events) {
    if (std::abs(event.power_w) > scenario.battery.physics.power_w_max) {
      table.fail("event", fmt::format("hold: {} W is more than the battery's {:g}", event.power_w,
                                      scenario.battery.physics.power_w_max));
    }
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

bool Scenario::has_limits() const {
  using enum ScenarioEvent::Does;
  const auto limits = [](const ScenarioEvent& e) {
    return e.does == kLimit || e.does == kLimitTorn;
  };
  return !edge_limits.empty() || std::ranges::any_of(events, limits);
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
  read_text(table, "title", scenario.title);
  read_time(table, scenario);
  read_battery(sub("battery"), folder, scenario.battery);
  read_prices(sub("prices"), folder, scenario.prices);
  read_house(sub("house"), scenario.house);
  read_meter(sub("meter"), folder, scenario.meter);
  read_meter_fault(sub("meter_fault"), scenario.meter);
  read_battery_fault(sub("battery_fault"), scenario.battery.rtu, scenario.battery_fault);
  read_price_fault(sub("price_fault"), scenario.price_fault);
  each(table, "event", [&](TomlTable event) { read_event(std::move(event), scenario); });
  each(table, "expect", [&](TomlTable expect) { read_expectation(std::move(expect), scenario); });
  read_edge(sub("edge"), scenario);
  read_judge(sub("judge"), scenario);
  check_site(table, scenario);
  check_events(table, scenario);
  check_beginnings(table, scenario);
  table.finish();
  if (!error.empty()) throw UserError(error);
  std::ranges::stable_sort(scenario.events, {}, &ScenarioEvent::at_min);
  return scenario;
}

}  // namespace bess
