// Map sections [power], [watchdog], [state] and [[identity]].
#include <algorithm>

#include "edge/device/registers/map_reader.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

void read_measured(TomlTable& table, RegisterMap& map) {
  for_each_text(table, "measure", [&](std::string_view name, const TomlValue& at) {
    const std::int8_t point = require_point(table, at, name, map);
    if (point < 0) return;
    if (std::ranges::count(map.measure, point) > 0) {
      return table.fail_at(at, "measure lists " + quoted(name) + " twice");
    }
    if (map.points[point].optional) {
      return table.fail_at(at,
                           quoted(name) + " is optional: name it in alarms, warnings or off_grid");
    }
    map.measure.push_back(point);  // fits: capacity for every point once
  });
}

/// "point" or "-point".
void read_term(TomlTable& table, const TomlValue& at, std::string_view text, const RegisterMap& map,
               PowerCase& out) {
  PowerCase::Term term;
  if (text.starts_with('-')) {
    term.sign = -1;
    text.remove_prefix(1);
  }
  term.point = require_point(table, at, text, map);
  if (term.point >= 0 && !out.terms.try_push_back(term)) {
    table.fail_at(at, "a power is the sum of at most 6 points");
  }
}

void read_power_case(TomlTable& table, const RegisterMap& map, StaticVector<PowerCase, 4>& cases) {
  PowerCase out;
  FixedText<63> when;
  table.require("power");
  table.text("when", when);
  if (table.has("when") && table.ok()) {
    parse_condition(table, *table.node("when"), when.view(), map, out.when);
  }
  for_each_text(table, "power", [&](std::string_view text, const TomlValue& at) {
    read_term(table, at, text, map, out);
  });
  if (table.ok() && !cases.try_push_back(out)) table.fail("power", "exceeds the limit of 4 cases");
}

void read_alive(TomlTable& state, RegisterMap& map) {
  const TomlValue* found = state.table("alive");
  if (found == nullptr) return;
  TomlTable table{found, state.file(), "[state] alive", state.error()};
  RegisterName name;
  table.require("point");
  table.require("max_age_s");
  table.text("point", name);
  table.integer("max_age_s", map.alive.max_age_s, 1, 3'600);
  table.finish();
  if (table.ok()) map.alive.point = require_point(table, *found, name.view(), map);
}

void read_identity_check(TomlTable& table, RegisterMap& map) {
  IdentityCheck check;
  RegisterName name;
  table.require("point");
  table.require("hint");
  table.text("point", name);
  table.text("hint", check.hint);
  table.text("text", check.text);
  table.integer("min", check.value_min, -kMapValueLimit, kMapValueLimit);
  table.integer("max", check.value_max, -kMapValueLimit, kMapValueLimit);
  table.boolean("may_be_unknown", check.may_be_unknown);
  if (!table.ok()) return;
  check.point = require_point(table, *table.value(), name.view(), map);
  if (!table.ok()) return;
  const bool is_text = map.points[check.point].type == RegisterType::kText;
  for (const std::string_view key : {"min", "max"}) {
    if (is_text && table.has(key)) table.fail(key, "needs a point that is a number");
    if (!is_text) table.require(key);
  }
  if (is_text) table.require("text");
  if (!is_text && table.has("text")) table.fail("text", "needs a point of type \"text\"");
  if (!map.identity.try_push_back(check)) table.fail("point", "exceeds the limit of 8 checks");
}

}  // namespace

void read_power_cases(TomlTable& table, std::string_view key, const RegisterMap& map,
                      StaticVector<PowerCase, 4>& cases) {
  const TomlValue* node = table.node(key);
  if (node == nullptr) return;
  if (const auto* text = node->as<std::string>()) {
    PowerCase always;
    read_term(table, *node, *text, map, always);
    return cases.push_back(always);
  }
  for_each_table(table, key, [&](TomlTable& item) { read_power_case(item, map, cases); });
}

void read_map_limits(TomlTable& root, RegisterMap& map) {
  TomlTable power = root.child("power");
  power.require("charge_w_max");
  power.require("discharge_w_max");
  power.integer("charge_w_max", map.charge_w_max, 1, 1'000'000'000);
  power.integer("discharge_w_max", map.discharge_w_max, 1, 1'000'000'000);
  power.finish();
}

void read_map_watchdog(TomlTable& root, RegisterMap& map) {
  TomlTable table = root.child("watchdog");
  RegisterName remaining;
  table.require("kind");
  table.choice("kind", map.watchdog.kind,
               {"none", "duration", "revert_timer", "heartbeat", "rewrite"});
  if (map.watchdog.kind != Watchdog::Kind::kNone) {
    table.require("duration_s");
    table.require("refresh_s");
  }
  table.integer("duration_s", map.watchdog.duration_s, 2, kSecondsPerDay);
  table.integer("refresh_s", map.watchdog.refresh_s, 1, 43'200);
  table.boolean("expiry_visible", map.watchdog.expiry_visible);
  table.text("remaining", remaining);
  if (table.has("remaining") && table.ok()) {
    map.watchdog.remaining = require_point(table, *table.node("remaining"), remaining.view(), map);
  }
  if (map.watchdog.kind == Watchdog::Kind::kNone) {
    map.watchdog.duration_s = map.watchdog.refresh_s = 0;  // a variant may inherit them
  }
  if (map.watchdog.refresh_s * 2 > map.watchdog.duration_s) {
    table.fail("refresh_s", "must be at most half of duration_s: one refresh may be lost");
  }
  table.finish();
}

void read_map_state(TomlTable& root, RegisterMap& map) {
  TomlTable state = root.child("state");
  read_measured(state, map);
  read_conditions(state, "active", map, map.active);
  read_conditions(state, "alarms", map, map.alarms);
  read_conditions(state, "warnings", map, map.warnings);
  for_each_text(state, "off_grid", [&](std::string_view text, const TomlValue& at) {
    parse_condition(state, at, text, map, map.off_grid);
  });
  read_power_cases(state, "measured_power", map, map.measured_power);
  read_power_cases(state, "order_power", map, map.order_power);
  read_power_cases(state, "grid_power", map, map.grid_power);
  read_alive(state, map);
  state.finish();
}

void read_map_identity(TomlTable& root, RegisterMap& map) {
  for_each_table(root, "identity", [&](TomlTable& table) { read_identity_check(table, map); });
}

}  // namespace bess
