// Map checks that need the whole map: roles present, references resolved, watchdog refreshed by the
// commands, and proof that the stated power range fits the registers.
#include <algorithm>

#include "edge/device/registers/codec.h"
#include "edge/device/registers/map_file.h"
#include "edge/device/registers/map_reader.h"

namespace bess {
namespace {

bool contains(const auto& list, std::int8_t point) { return std::ranges::count(list, point) > 0; }

/// A point of that name is the power, unless the map defines it otherwise.
void complete_power(RegisterMap& map, std::string_view name, StaticVector<PowerCase, 4>& cases) {
  const int point = find_point(map, name);
  if (!cases.empty() || point < 0) return;
  PowerCase always;
  always.terms.push_back({.point = static_cast<std::int8_t>(point)});
  cases.push_back(always);
}

/// Points used by state and commands are read every cycle, whether listed or not.
void measure_also(RegisterMap& map, std::int8_t point) {
  if (point < 0 || contains(map.measure, point)) return;
  map.measure.push_back(point);  // fits: capacity for every point once
}

void measure_power(RegisterMap& map, const StaticVector<PowerCase, 4>& cases) {
  for (const PowerCase& c : cases) {
    measure_also(map, c.when.point);
    for (const PowerCase::Term& term : c.terms) measure_also(map, term.point);
  }
}

bool keeps_from_harm(const RegisterMap& map, std::int8_t point) {
  constexpr std::string_view kNames[] = {"temperature_min", "temperature_max", "charge_power_max",
                                         "discharge_power_max"};
  return std::ranges::count(kNames, map.points[point].name.view()) > 0 ||
         point == map.off_grid.point ||
         std::ranges::count(map.alarms, point, &Condition::point) > 0;
}

bool is_power(const RegisterMap& map, std::int8_t point) {
  return std::ranges::any_of(map.measured_power, [&](const PowerCase& c) {
    return c.when.point == point || std::ranges::count(c.terms, point, &PowerCase::Term::point) > 0;
  });
}

/// Listed points, power and alarms determine orders. The others only show the order in force, or
/// warn.
void complete_measure(RegisterMap& map) {
  for (const Condition& c : map.alarms) measure_also(map, c.point);
  measure_also(map, map.off_grid.point);
  measure_also(map, map.alive.point);
  measure_power(map, map.measured_power);
  for (const std::int8_t point : map.measure) {
    if (is_power(map, point) || !(keeps_from_harm(map, point) || map.points[point].optional)) {
      map.required.push_back(point);
    } else {
      map.protective.push_back(point);
    }
  }
  for (const Condition& c : map.warnings) measure_also(map, c.point);
  for (const Condition& c : map.active) measure_also(map, c.point);
  measure_also(map, map.watchdog.remaining);
  measure_power(map, map.order_power);
  for (const RegisterPoint& p : map.points) {
    for (const std::int8_t scale : {p.scale_from, p.percent_of, p.clamp_to}) {
      measure_also(map, scale);
      if (scale >= 0 && !contains(map.scales, scale)) map.scales.push_back(scale);
    }
  }
  for_each_written(map, [&map](const WriteValue& value) {
    measure_also(map, value.plus);
    if (value.plus >= 0 && !contains(map.scales, value.plus)) map.scales.push_back(value.plus);
  });
}

bool writes_argument(const RegisterMap& map, Command command, Argument wanted) {
  for (const BlockWrite& write : map.sequence(command).writes) {
    for (const WriteValue& value : write.values) {
      if (value.argument == wanted) return true;
    }
  }
  return false;
}

bool is_fed_by(const RegisterMap& map, Command command) {
  const Watchdog::Kind kind = map.watchdog.kind;
  if (kind == Watchdog::Kind::kHeartbeat) {
    return writes_argument(map, command, Argument::kHeartbeat);
  }
  const bool has_timer = kind == Watchdog::Kind::kDuration || kind == Watchdog::Kind::kRevertTimer;
  return !has_timer || writes_argument(map, command, Argument::kDuration) ||
         writes_argument(map, command, Argument::kDurationMinutes);
}

/// Without a refresh the watchdog would end every order, or never one.
void check_watchdog(TomlTable& root, const RegisterMap& map) {
  for (const Command command : {Command::kCharge, Command::kIdle, Command::kDischarge}) {
    if (is_fed_by(map, command) || is_fed_by(map, Command::kEnable)) continue;
    root.fail("watchdog",
              "is not refreshed: charge, idle and discharge (or enable) must write "
              "\"duration\", \"duration_minutes\" or \"heartbeat\"");
  }
  const bool refreshes = !map.sequence(Command::kRefresh).writes.empty();
  if (refreshes && !is_fed_by(map, Command::kRefresh)) {
    root.fail("command", "refresh must refresh the watchdog: write its duration or heartbeat");
  }
}

void check_roles(TomlTable& root, const RegisterMap& map) {
  const int soc = find_point(map, "soc");
  if (soc < 0 || !contains(map.required, static_cast<std::int8_t>(soc))) {
    root.fail("state", "measure must hold a point \"soc\": the controller needs it");
  }
  if (map.measured_power.empty()) {
    root.fail("point",
              "\"battery_power\" is missing: the controller needs it (or measured_power in "
              "[state])");
  }
  for (const std::int8_t point : map.measure) {
    if (map.points[point].type != RegisterType::kText) continue;
    root.fail("state", "measures " + quoted(map.points[point].name.view()) +
                           ", which is text: use it in [[identity]] only");
  }
}

bool is_reported(const RegisterMap& map, int point) {
  return map.off_grid.point == point ||
         std::ranges::count(map.alarms, point, &Condition::point) > 0 ||
         std::ranges::count(map.warnings, point, &Condition::point) > 0;
}

bool is_written(const RegisterMap& map, int point) {
  bool is_found = false;
  for_each_written(map,
                   [&](const WriteValue& value) { is_found = is_found || value.point == point; });
  return is_found;
}

/// No other part may rely on a point that a device may lack.
void check_optional(TomlTable& root, const RegisterMap& map) {
  for (int point = 0; point < map.points.size(); ++point) {
    const RegisterPoint& p = map.points[point];
    const bool is_used = is_reported(map, point) || is_power(map, static_cast<std::int8_t>(point));
    if (!p.optional || (is_used && !is_written(map, point))) continue;
    root.fail("point", quoted(p.name.view()) +
                           " is optional: only alarms, warnings, off_grid and "
                           "measured_power may use it");
  }
  for (const RegisterPoint& p : map.points) {
    for (const std::int8_t other : {p.scale_from, p.percent_of, p.clamp_to}) {
      if (other < 0 || !map.points[other].optional) continue;
      root.fail("point", quoted(p.name.view()) + " needs " + quoted(map.points[other].name.view()) +
                             ", which is optional");
    }
  }
}

/// "saved" without a fallback would restore 0; a saved point without a restore is an error.
void check_saved(TomlTable& root, const RegisterMap& map) {
  for_each_written(map, [&](const WriteValue& value) {
    const bool listed = std::ranges::count(map.saved, value.point, &SavedPoint::point) > 0;
    if (value.argument != Argument::kSaved || listed) return;
    root.fail("command", "restores " + quoted(map.points[value.point].name.view()) +
                             ", which is not in the list save");
  });
  for (const SavedPoint& saved : map.saved) {
    if (map.points[saved.point].registers <= kPointRegistersMax) continue;
    root.fail("command", "cannot save text");
  }
}

void check_addresses(TomlTable& root, const RegisterMap& map) {
  for (int i = 0; i < map.points.size(); ++i) {
    const RegisterPoint& p = map.points[i];
    const std::int64_t end = std::int64_t{p.address} + p.registers;
    if (end > 65'536) root.fail("point", quoted(p.name.view()) + " is beyond address 65535");
  }
}

/// A meter map needs grid power only.
void check_meter(TomlTable& root, RegisterMap& map) {
  if (!measure_grid_power(map)) {
    root.fail("point",
              "\"grid_power\" is missing: a meter map needs it (or grid_power in [state])");
  }
  check_addresses(root, map);
}

/// A release must remain possible when the daily flash writes are used up.
void check_reserve(TomlTable& root, const RegisterMap& map) {
  int worn = 0;
  for (const RegisterPoint& p : map.points) worn += p.eeprom ? 1 : 0;
  int release = 0;
  for (const BlockWrite& write : map.sequence(Command::kRelease).writes) {
    release += write.eeprom ? 1 : 0;
  }
  if (worn > 0 && map.writes.eeprom_writes_per_day == 0) {
    root.fail("writes", "eeprom_writes_per_day is missing: some points have storage = \"eeprom\"");
  }
  if (map.writes.eeprom_writes_per_day > 0 && map.writes.reserve < release) {
    root.fail("writes", "reserve must be at least " + std::to_string(release) +
                            ": the writes of one release");
  }
}

/// Checks the duration sent with every order on its own, so that the error does not blame the
/// power.
void prove_watchdog_duration(TomlTable& root, const RegisterMap& map) {
  const std::string duration_text =
      "duration_s = " + std::to_string(map.watchdog.duration_s) + " is ";
  const PointValues assumed = assumed_live_points(map, false);
  for_each_written(map, [&](const WriteValue& value) {
    const bool in_minutes = value.argument == Argument::kDurationMinutes;
    if (!in_minutes && value.argument != Argument::kDuration) return;
    const RegisterPoint& p = map.points[value.point];
    const std::int64_t time =
        in_minutes ? (map.watchdog.duration_s + 59) / 60 : map.watchdog.duration_s;
    Scaling scaling;
    RegisterBlock block;
    if (!live_scaling(map, assumed, value.point, scaling)) return;
    if (encode(p, time, Rounding::kNearest, block, scaling) == Status::kOk) return;
    root.fail("watchdog", duration_text + std::to_string(time) + (in_minutes ? " min" : " s") +
                              ", which the point " + quoted(p.name.view()) +
                              " cannot express (min, max, type)");
  });
}

/// Overflow is excluded: both ends of the stated power range are encoded once here.
void prove_power_range(TomlTable& root, const RegisterMap& map) {
  for (const std::int32_t power_w : {map.charge_w_max, -map.discharge_w_max, 0}) {
    const PowerOrder order{.power_w = power_w, .duration_s = map.watchdog.duration_s};
    if (check_expressible(map, order) != Status::kOk) {
      root.fail("power",
                "states " + std::to_string(power_w) + " W, which the registers cannot express");
    }
  }
}

}  // namespace

bool measure_grid_power(RegisterMap& map) {
  measure_power(map, map.grid_power);
  return !map.grid_power.empty();
}

void check_map(TomlTable& root, RegisterMap& map) {
  if (!root.ok()) return;
  complete_power(map, "battery_power", map.measured_power);
  complete_power(map, "grid_power", map.grid_power);
  complete_measure(map);
  if (map.is_meter) return check_meter(root, map);
  for (const auto check :
       {check_roles, check_optional, check_watchdog, check_saved, check_addresses, check_reserve,
        prove_watchdog_duration, prove_power_range}) {
    if (root.ok()) check(root, map);
  }
}

}  // namespace bess
