// Map sections [writes], [exceptions], [response], [commissioning] and [simulator].
#include "edge/device/registers/map_reader.h"

namespace bess {
namespace {

void read_assignments(TomlTable& table, std::string_view key, const RegisterMap& map, auto& out) {
  using Assignment = SimulatorHints::Assignment;
  for_each_text(table, key, [&](std::string_view text, const TomlValue& at) {
    const MapPhrase phrase = split_phrase(text);
    Assignment assignment{.point = require_point(table, at, phrase.left, map)};
    if (assignment.point < 0) return;
    if (phrase.op == "=" && phrase.right == "power_max") {
      assignment.source = Assignment::Source::kPowerMax;
    } else if (phrase.op == "=" && phrase.right == "capacity") {
      assignment.source = Assignment::Source::kCapacity;
    } else if (phrase.op != "=" ||
               !parse_value(map, assignment.point, phrase.right, assignment.constant)) {
      return table.fail_at(at, "must be \"point = number, name, power_max or capacity\"");
    }
    if (!out.try_push_back(assignment)) table.fail(key, "is too long");
  });
}

/// SoC change per register count, unless the map states a coarser step.
std::int32_t soc_register_step_e4(const RegisterMap& map) {
  const int soc = find_point(map, "soc");
  if (soc < 0) return ResponseBand{}.soc_step_e4;
  const RegisterPoint& p = map.points[soc];
  const bool is_scaled_live = p.scale_from >= 0 || p.percent_of >= 0;
  const std::int64_t step_e4 = is_scaled_live ? 100 : p.scale / p.scale_divisor;
  return static_cast<std::int32_t>(step_e4 < 1 ? 1 : step_e4 > 1'000 ? 1'000 : step_e4);
}

void read_response(TomlTable& root, RegisterMap& map) {
  TomlTable table = root.child("response");
  map.response.soc_step_e4 = soc_register_step_e4(map);
  table.integer("settle_s", map.response.settle_s, 1, kSettleSMax);
  table.integer("tolerance_percent", map.response.tolerance_percent, 1, 50);
  table.integer("tolerance_w", map.response.tolerance_w, 1, 1'000'000);
  table.integer("soc_step_e4", map.response.soc_step_e4, 1, 1'000);
  table.integer("soc_refresh_s", map.response.soc_refresh_s, 1, 600);
  table.boolean("charges_by_itself", map.response.charges_by_itself);
  table.finish();
}

}  // namespace

void read_map_policies(TomlTable& root, RegisterMap& map) {
  TomlTable writes = root.child("writes");
  writes.integer("eeprom_writes_per_day", map.writes.eeprom_writes_per_day, 1, 100'000);
  writes.integer("reserve", map.writes.reserve, 0, 1'000);
  if (map.writes.reserve > 0 && map.writes.reserve >= map.writes.eeprom_writes_per_day) {
    writes.fail("reserve", "must be below eeprom_writes_per_day");
  }
  writes.finish();
  TomlTable exceptions = root.child("exceptions");
  read_numbers(exceptions, "retry", 1, 255, map.exceptions.retry);
  read_numbers(exceptions, "not_permitted", 1, 255, map.exceptions.not_permitted);
  exceptions.finish();
  read_response(root, map);
  TomlTable test = root.child("commissioning");
  test.integer("power_w", map.commissioning.power_w, 1, 1'000'000);
  test.integer("duration_s", map.commissioning.duration_s, 5, 600);
  test.integer("settle_s", map.commissioning.settle_s, 1, 300);
  test.integer("tolerance_percent", map.commissioning.tolerance_percent, 1, 100);
  if (map.commissioning.settle_s >= map.commissioning.duration_s) {
    test.fail("settle_s", "must be below duration_s");
  }
  test.finish();
}

void read_map_simulator(TomlTable& root, RegisterMap& map) {
  TomlTable table = root.child("simulator");
  read_conditions(table, "active", map, map.simulator.active);
  read_power_cases(table, "order_power", map, map.simulator.order_power);
  read_assignments(table, "initial", map, map.simulator.initial);
  read_assignments(table, "at_expiry", map, map.simulator.at_expiry);
  for_each_text(table, "apply_on", [&](std::string_view name, const TomlValue& at) {
    const std::int8_t point = require_point(table, at, name, map);
    if (point >= 0 && !map.simulator.apply_on.try_push_back(point)) {
      table.fail("apply_on", "is too long");
    }
  });
  table.finish();
}

}  // namespace bess
