#include "tools/hil_runner/scenario/scenario.h"

#include <cmath>

#include "edge/core/control/price_history.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/hil_runner/scenario/scenario_parts.h"
#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr double kWallMinutesMax = 180;

void read_battery(TomlTable table, const fs::path& folder, ScenarioBattery& battery) {
  std::string map = kUsualMap;
  read_text(table, "map", map);
  battery.names_map = table.has("map");
  for (const char* key : {"soc", "power_w", "capacity_wh", "soc_floor", "soc_ceiling"}) {
    battery.sets_state = battery.sets_state || table.has(key);
  }
  battery.map = map_path(map, folder);
  if (table.ok() && !fs::exists(battery.map)) {
    table.fail("map", "names no register map: " + battery.map + kMapsOfTheBuild);
  }
  read_text(table, "variant", battery.variant);
  table.choice("transport", battery.rtu, {"tcp", "rtu"});
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

void read_prices(TomlTable table, const fs::path& folder, Scenario& scenario) {
  ScenarioPrices& prices = scenario.prices;
  if (int{table.has("file")} + int{table.has("steps")} + int{table.has("wave")} > 1) {
    table.fail(table.has("file") ? "file" : "steps",
               "conflicts with another of file, steps and wave");
  }
  read_text(table, "file", prices.file);
  if (!prices.file.empty()) prices.file = (folder / prices.file).lexically_normal().string();
  read_steps(table, scenario.minutes, prices.steps);
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
  read_pairs(table, "missing", [&](double from, double to) -> std::string {
    if (std::ceil(from) >= to) return "must contain a minute (from, up to but not including to)";
    if (from >= scenario.minutes) return after_the_end(scenario.minutes);
    prices.missing.push_back({.from_min = from, .to_min = to});
    return "";
  });
  table.finish();
}

/// Keys of a fault that none of its kinds uses, and contradictions.
void check_battery_fault(TomlTable& table, const FaultSchedule& schedule) {
  using enum BatteryFault;
  struct FaultOption {
    const char* key;
    std::vector<BatteryFault> kinds;
    const char* names;
  };
  const FaultOption keys[] = {{"late_ms", {kLate, kByteGap}, "late, byte-gap"},
                              {"drip_ms", {kDrip}, "drip"},
                              {"exception_code", {kException}, "exception"},
                              {"period_s",
                               {kOtherMaster, kMasterStops, kMasterMode, kEndsOrders},
                               "other-master, master-stops, master-mode, ends-orders"}};
  const auto& faults = schedule.faults;
  for (const FaultOption& key : keys) {
    if (table.has(key.key) && std::ranges::find_first_of(faults, key.kinds) == faults.end()) {
      table.fail(key.key, fmt::format("is only for {}", key.names));
    }
  }
  if (table.has("every") && table.has("probability")) {
    table.fail("every", "or probability: at most one is allowed");
  }
}

void read_battery_fault(TomlTable table, Scenario& scenario) {
  if (table.value() == nullptr) return;
  FaultSchedule& fault = scenario.battery_faults.emplace_back();
  const bool rtu = scenario.battery.rtu;
  read_fault_times(table, scenario.minutes, fault);
  table.integer("every", fault.every, 1, 1'000'000);
  read_decimal(table, "probability", fault.probability, 0, 1);
  table.integer("seed", fault.seed, 0, INT64_MAX);
  table.integer("period_s", fault.period_s, 1, kSecondsPerDay);
  table.integer("late_ms", fault.late_ms, 1, 60'000);
  table.integer("drip_ms", fault.drip_ms, 1, 60'000);
  table.integer("exception_code", fault.exception_code, 1, 255);
  read_fault_kinds(table, fault.faults, [rtu](const BatteryFaultInfo& info) {
    if (rtu ? info.rtu : info.tcp) return std::string();
    return std::string(rtu ? "not on a serial line" : "only on a serial line");
  });
  check_battery_fault(table, fault);
  table.finish();
}

/// Calls `read(table, scenario)` for each table of a list.
void each(TomlTable& table, const std::string& key, Scenario& scenario,
          void (*read)(TomlTable, Scenario&)) {
  const TomlArray* const list = table.array(key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    read({&(*list)[i], table.file(), "[[" + key + "]]", table.error()}, scenario);
  }
}

/// [battery_fault], or several [[battery_fault]].
void read_battery_faults(TomlTable& table, Scenario& scenario) {
  const TomlValue* const node = table.node("battery_fault");
  if (node == nullptr) return;
  if (node->as<TomlArray>() == nullptr)
    return read_battery_fault(table.child("battery_fault"), scenario);
  each(table, "battery_fault", scenario, read_battery_fault);
  const auto& faults = scenario.battery_faults;
  if (table.ok() && faults.size() > 1 && scenario.runs_wall) {
    table.fail("battery_fault",
               "with several entries requires time = \"virtual\": bess-sim accepts one");
  }
  const auto acts = [](const FaultSchedule& fault) {
    return std::ranges::any_of(fault.faults, is_by_period);
  };
  const auto first = std::ranges::find_if(faults, acts);
  const auto differs = [&](const FaultSchedule& fault) {
    return acts(fault) && fault.period_s != first->period_s;
  };
  if (table.ok() && std::ranges::any_of(faults, differs)) {
    table.fail("battery_fault", "has different values of period_s; they must be equal");
  }
}

void read_price_fault(TomlTable table, Scenario& scenario) {
  if (table.value() == nullptr) return;
  MarketFaultSchedule& fault = scenario.price_fault;
  read_fault_span(table, scenario.minutes, fault);
  table.integer("every", fault.every, 1, 1'000'000);
  int kind = 0;
  table.require("kind");
  table.choice("kind", kind, std::span(kMarketFaultNames).subspan(1));  // without none
  fault.fault = static_cast<MarketFault>(kind + 1);
  // Use steps of [prices] for a price that moves again, or is frozen in some answers.
  const bool is_partly_frozen = fault.every > 1 || fault.to_s != kNeverMin;
  if (table.ok() && fault.fault == MarketFault::kFrozen && is_partly_frozen) {
    table.fail("kind", "frozen lasts to the end, in every answer: omit every and to_min");
  }
  table.finish();
}

void read_judge(TomlTable table, Scenario& scenario) {
  for (const RuleInfo& info : kRuleInfos) scenario.invariants.emplace_back(info.name);
  if (const TomlArray* const list = table.array("all_but")) {
    for (const TomlValue& item : *list) {
      const auto* const name = item.as<std::string>();
      if (name == nullptr || std::erase(scenario.invariants, *name) == 0) {
        table.fail_at(item, "unknown rule (see bess-hil run --invariants)");
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
  if (table.has("time_scale") && !scenario.runs_wall) {
    table.fail("time_scale", "is only for wall time, which this scenario excludes");
  }
  if (table.ok() && scenario.runs_wall && scenario.minutes > kWallMinutesMax) {
    table.fail("minutes", fmt::format("over {:g} requires time = \"virtual\"", kWallMinutesMax));
  }
}

/// Excuses for parts of the scenario.
void read_same_without(TomlTable table, Scenario& scenario) {
  if (table.value() == nullptr) return;
  const std::vector<ScenarioPart> parts = parts_of(scenario);
  std::string names = parts.empty() ? std::string(kNothing) : "";
  for (const ScenarioPart& part : parts) {
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", part.name);
  }
  for (const auto& [name, value] : *table.value()->as<TomlMembers>()) {
    const bool is_part = parts.empty()
                             ? name == kNothing
                             : std::ranges::find(parts, name, &ScenarioPart::name) != parts.end();
    std::string& why = scenario.same_without[name];
    read_text(table, name, why);
    if (!is_part) return table.fail(name, "is not a part of this scenario, which has " + names);
    if (table.ok() && why.empty()) table.fail(name, "needs a reason");
  }
}

}  // namespace

std::string map_path(const std::string& name, const fs::path& folder, bool is_meter) {
  if (name.find('/') == std::string::npos && !name.ends_with(".toml")) {
    return std::string(is_meter ? BESS_METER_DIR : BESS_MAP_DIR) + "/" + name + ".toml";
  }
  return fs::absolute(folder / name).lexically_normal().string();
}

bool Scenario::has_limits() const {
  using enum ScenarioEvent::EventKind;
  const auto limits = [](const ScenarioEvent& e) {
    return e.kind == kLimit || e.kind == kLimitTorn;
  };
  return !edge_limits.empty() || std::ranges::any_of(events, limits);
}

std::int64_t Scenario::utc_ns_at(double minute) const {
  if (minute == kNeverMin) return INT64_MAX;
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
  table.require("title");
  read_text(table, "title", scenario.title);
  table.boolean("witness", scenario.witness);
  read_time(table, scenario);
  read_battery(table.child("battery"), folder, scenario.battery);
  read_prices(table.child("prices"), folder, scenario);
  read_house(table.child("house"), scenario);
  read_meter(table.child("meter"), folder, scenario.meter);
  read_meter_fault(table.child("meter_fault"), scenario);
  read_battery_faults(table, scenario);
  read_price_fault(table.child("price_fault"), scenario);
  read_day_ahead(table.child("day_ahead"), folder, scenario);
  each(table, "event", scenario, read_event);
  each(table, "expect", scenario, read_expectation);
  read_edge(table.child("edge"), scenario);
  read_judge(table.child("judge"), scenario);
  std::ranges::stable_sort(scenario.events, {}, &ScenarioEvent::at_min);
  read_same_without(table.child("same_without"), scenario);
  check_site(table, scenario);
  check_events(table, scenario);
  table.finish();
  if (!error.empty()) throw UserError(error);
  return scenario;
}

}  // namespace bess
