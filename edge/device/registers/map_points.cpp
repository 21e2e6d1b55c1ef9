// Map sections [map], [unit_groups], [sunspec] and [[point]].
#include <algorithm>

#include "edge/device/registers/map_reader.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

struct TypeFacts {
  std::string_view name;
  std::uint8_t registers;  ///< 0: set by the map
  std::uint64_t sunspec_not_implemented;
  std::uint64_t other_extreme;  ///< largest value of signed numbers; 0 = none
};

/// In the order of RegisterType; raw values of the SunSpec information model specification.
constexpr TypeFacts kTypes[] = {{"u16", 1, 0xFFFF, 0},      {"s16", 1, 0x8000, 0x7FFF},
                                {"u32", 2, 0xFFFF'FFFF, 0}, {"s32", 2, 0x8000'0000, 0x7FFF'FFFF},
                                {"u64", 4, UINT64_MAX, 0},  {"f32", 2, 0x7FC0'0000, 0},
                                {"text", 0, 0, 0}};

void read_unit_groups(TomlTable& root, RegisterMap& map) {
  TomlTable groups = root.child("unit_groups");
  if (groups.value() == nullptr) return;
  for (const auto& [key, node] : *groups.value()->as<TomlMembers>()) {
    UnitGroup group;
    groups.integer(key, group.unit, 0, 255);
    if (!group.name.assign(key)) groups.fail(key, "is a name of more than 31 characters");
    if (!map.unit_groups.try_push_back(group)) groups.fail(key, "exceeds the limit of 4 groups");
  }
  groups.finish();
}

void read_sunspec(TomlTable& root, RegisterMap& map) {
  TomlTable table = root.child("sunspec");
  if (table.value() == nullptr) return;
  table.require("models");
  read_numbers(table, "models", 0, 65'534, map.models);
  read_numbers(table, "bases", 0, 65'000, map.model_bases);
  table.finish();
  if (map.model_bases.empty()) {
    constexpr std::uint16_t kUsualBases[] = {40'000, 50'000, 0};
    for (const std::uint16_t base : kUsualBases) map.model_bases.push_back(base);
  }
}

void read_reference(TomlTable& table, std::string_view key, const RegisterMap& map,
                    std::int8_t& point) {
  RegisterName name;
  table.text(key, name);
  if (!table.has(key) || !table.ok()) return;
  point = require_point(table, *table.node(key), name.view(), map);
  if (point >= 0 && map.points[point].percent_of >= 0) {
    table.fail(key, "must not itself be a percentage");
  }
}

void read_model(TomlTable& table, const RegisterMap& map, RegisterPoint& point) {
  std::int32_t model = 0;
  table.integer("model", model, 1, 65'534);
  if (!table.has("model") || !table.ok()) return;
  for (int i = 0; i < map.models.size(); ++i) {
    if (map.models[i] == model) point.model = static_cast<std::int8_t>(i);
  }
  if (point.model < 0) table.fail("model", "is not in the list [sunspec] models");
}

void read_unit_group(TomlTable& table, const RegisterMap& map, RegisterPoint& point) {
  RegisterName name;
  table.text("unit_group", name);
  if (!table.has("unit_group") || !table.ok()) return;
  for (int i = 0; i < map.unit_groups.size(); ++i) {
    if (map.unit_groups[i].name == name.view()) point.unit_group = static_cast<std::int8_t>(i);
  }
  if (point.unit_group < 0) table.fail("unit_group", "is not a name in [unit_groups]");
}

void read_place(TomlTable& table, const MapDefaults& defaults, const RegisterMap& map,
                RegisterPoint& point) {
  read_model(table, map, point);
  const std::int32_t base = point.model >= 0 ? 0 : defaults.address_base;
  std::int32_t address = base;
  table.integer("address", address, base, 65'535);
  point.read_function = defaults.read_function;
  table.integer("read_function", point.read_function, 3, 4);
  read_unit_group(table, map, point);
  point.address = static_cast<std::uint16_t>(address - base);
}

void read_type(TomlTable& table, const MapDefaults& defaults, RegisterPoint& point) {
  point.word_order = defaults.word_order;
  table.choice("type", point.type, {"u16", "s16", "u32", "s32", "u64", "f32", "text"});
  table.choice("word_order", point.word_order, {"high_first", "low_first"});
  const TypeFacts& type = kTypes[static_cast<int>(point.type)];
  point.registers = std::max<std::uint8_t>(type.registers, 1);
  const int most = point.type == RegisterType::kText ? kTextRegistersMax : point.registers;
  table.integer("registers", point.registers, point.registers, most);
  table.integer("mask", point.mask, 1, 0xFFFF'FFFF);
  if (point.mask != 0 && point.type != RegisterType::kU16 && point.type != RegisterType::kU32) {
    table.fail("mask", "needs type \"u16\" or \"u32\"");
  }
  read_numbers(table, "not_implemented", 0, INT64_MAX, point.not_implemented);
  if (table.has("not_implemented")) return;
  if (defaults.not_implemented >= 1 && type.sunspec_not_implemented != 0) {
    point.not_implemented.push_back(type.sunspec_not_implemented);
  }
  if (defaults.not_implemented == 2 && type.other_extreme != 0) {
    point.not_implemented.push_back(type.other_extreme);
  }
}

/// Treatment of values beyond the range. A full battery may report 100.4 %; a power limit above any
/// order, or none, is no limit.
void read_policy(TomlTable& table, RegisterPoint& point) {
  const auto name = point.name.view();
  const bool is_limit = name == "charge_power_max" || name == "discharge_power_max";
  constexpr std::int64_t kSocSlackE4 = 500;
  point.unknown_is_max = is_limit;
  point.slack = is_limit ? kMapValueLimit : name == "soc" ? kSocSlackE4 : 0;
  table.integer("slack", point.slack, 0, kMapValueLimit);
  table.integer("raw_at_max", point.raw_at_max, 1, 65'535);
  table.choice("unknown", point.unknown_is_max, {"reject", "max"});
}

void read_scale(TomlTable& table, const RegisterMap& map, RegisterPoint& point) {
  table.integer("scale", point.scale, 1, 1'000'000);
  table.integer("scale_divisor", point.scale_divisor, 1, 1'000'000);
  table.integer("offset", point.offset, -1'000'000'000, 1'000'000'000);
  table.integer("sign", point.sign, -1, 1);
  table.integer("step", point.step, 1, 1'000'000);
  table.integer("min", point.value_min, -kMapValueLimit, kMapValueLimit);
  table.integer("max", point.value_max, -kMapValueLimit, kMapValueLimit);
  read_policy(table, point);
  read_reference(table, "scale_from", map, point.scale_from);
  read_reference(table, "percent_of", map, point.percent_of);
  read_reference(table, "clamp_to", map, point.clamp_to);
  if (point.sign == 0) table.fail("sign", "must be 1 or -1");
  if (point.value_min > point.value_max) table.fail("min", "must not be above max");
  if (point.scale_from >= 0 && map.points[point.scale_from].scale_from >= 0) {
    table.fail("scale_from", "must not itself be scaled by another point");
  }
}

/// names = { charge = 1, ... } for values, bits = { fault = 3, ... } for bit numbers.
void read_names(TomlTable& table, std::string_view key, bool bits, RegisterMap& map) {
  const TomlValue* names = table.table(key);
  if (names == nullptr || !table.ok()) return;
  for (const auto& [name, node] : *names->as<TomlMembers>()) {
    NamedValue named;
    named.point = static_cast<std::int8_t>(map.points.size() - 1);
    named.is_bit = bits;
    const auto* number = node.as<std::int64_t>();
    if (number == nullptr || *number < (bits ? 0 : -kMapValueLimit) ||
        *number > (bits ? 31 : kMapValueLimit)) {
      return table.fail_at(
          node, std::string(key) + " must hold numbers" + (bits ? " of bits, 0 to 31" : ""));
    }
    named.value = bits ? std::int64_t{1} << *number : *number;
    if (!named.name.assign(name)) return table.fail_at(node, "name is longer than 23 characters");
    if (!map.names.try_push_back(named)) return table.fail(key, "exceeds the limit of 96 names");
  }
}

void read_point(TomlTable& table, const MapDefaults& defaults, RegisterMap& map) {
  RegisterPoint point;
  FixedText<15> unit;  // documentation only
  table.require("name");
  table.require("address");
  table.text("name", point.name);
  table.text("unit", unit);
  read_place(table, defaults, map, point);
  read_type(table, defaults, point);
  read_scale(table, map, point);
  table.choice("storage", point.eeprom, {"volatile", "eeprom"});
  table.integer("max_age_s", point.max_age_s, 0, kSecondsPerDay);
  table.boolean("optional", point.optional);
  table.boolean("private", point.is_private);
  if (point.type != RegisterType::kText) {
    table.require("min");
    table.require("max");
  }
  if (point.name.view().find_first_of("= !/") != std::string_view::npos || point.name.empty()) {
    table.fail("name", "must be one word without = ! /");
  }
  if (find_point(map, point.name.view()) >= 0) table.fail("name", "is used twice");
  if (!map.points.try_push_back(point)) {
    table.fail("name", "exceeds the limit of " + std::to_string(map.points.capacity()) + " points");
  }
  read_names(table, "names", false, map);
  read_names(table, "bits", true, map);
}

}  // namespace

void read_map_header(TomlTable& root, RegisterMap& map, MapDefaults& defaults) {
  TomlTable table = root.child("map");
  for (const std::string_view key : {"name", "unit"}) table.require(key);
  FixedText<255> description;  // description and one_client are documentation only
  bool one_client = false;
  table.choice("kind", map.is_meter, {"battery", "meter"});
  table.text("name", map.name);
  table.text("description", description);
  table.integer("unit", map.unit, 0, 255);
  table.integer("port", map.port, 1, 65'535);
  table.integer("baud", map.baud, 1'200, 256'000);
  table.choice("parity", map.parity, {"none", "even", "odd"});
  table.integer("stop_bits", map.stop_bits, 1, 2);
  table.integer("connect_delay_ms", map.connect_delay_ms, 0, 10'000);
  table.integer("minimum_gap_ms", map.minimum_gap_ms, 0, 10'000);
  table.integer("response_timeout_ms", map.response_timeout_ms, 10, 30'000);
  table.integer("read_gap_registers_max", map.read_gap_registers_max, 0, 60);
  table.integer("registers_per_read_max", map.registers_per_read_max, 4, 120);
  table.boolean("one_client", one_client);
  table.integer("read_function", defaults.read_function, 3, 4);
  table.integer("write_function", defaults.write_function, 6, 16);
  table.integer("address_base", defaults.address_base, 0, 1);
  table.choice("word_order", defaults.word_order, {"high_first", "low_first"});
  table.choice("not_implemented", defaults.not_implemented, {"none", "sunspec", "extremes"});
  if (defaults.write_function != 6 && defaults.write_function != 16) {
    table.fail("write_function", "must be 6 or 16");
  }
  table.finish();
  read_unit_groups(root, map);
  read_sunspec(root, map);
}

void read_map_points(TomlTable& root, const MapDefaults& defaults, RegisterMap& map) {
  for_each_table(root, "point", [&](TomlTable& table) { read_point(table, defaults, map); });
}

}  // namespace bess
