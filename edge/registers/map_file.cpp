#include "edge/registers/map_file.h"

#include "edge/registers/codec.h"
#include "edge/registers/toml_reader.h"

namespace bess {
namespace {

constexpr std::int64_t kValueLimit = 1'000'000'000;
constexpr std::string_view kCommandNames[kCommandCount] = {"charge", "idle", "discharge",
                                                           "release"};

std::string quoted(std::string_view name) { return std::string("\"").append(name).append("\""); }

TomlTable child(TomlTable& parent, const toml::table* table, std::string where) {
  return {table, parent.file(), std::move(where), parent.error()};
}

/// Calls `read` with each table of the list `key`, named e.g. [[point]].
template <typename Function>
void for_each_table(TomlTable& parent, std::string_view key, Function read) {
  const toml::array* list = parent.array(key);
  if (list == nullptr) return;
  for (const toml::node& item : *list) {
    if (!item.is_table()) return parent.fail_at(item, std::string(key) + " must hold tables");
    TomlTable table = child(parent, item.as_table(), std::string("[[").append(key).append("]]"));
    read(table);
    table.finish();
  }
}

std::int8_t point_index(TomlTable& table, const toml::node& at, std::string_view name,
                        const RegisterMap& map) {
  const int index = find_point(map, name);
  if (index < 0) table.fail_at(at, "no [[point]] is named " + quoted(name));
  return static_cast<std::int8_t>(index);
}

void read_point_list(TomlTable& table, std::string_view key, const RegisterMap& map, auto& out) {
  const toml::array* list = table.array(key);
  if (list == nullptr) return;
  for (const toml::node& item : *list) {
    const auto* name = item.as_string();
    if (name == nullptr) return table.fail_at(item, std::string(key) + " must hold point names");
    const std::int8_t index = point_index(table, item, name->get(), map);
    if (index < 0) return;
    if (!out.try_push_back(index)) return table.fail(key, "holds too many points");
  }
}

void read_condition(TomlTable& parent, std::string_view key, const RegisterMap& map,
                    Condition& condition) {
  const toml::table* found = parent.table(key);
  if (found == nullptr) return;
  TomlTable table = child(parent, found, parent.where() + " " + std::string(key));
  RegisterName name;
  table.require("point");
  table.text("point", name);
  table.integer("value", condition.value, -kValueLimit, kValueLimit);
  table.finish();
  if (table.ok()) condition.point = point_index(table, *found, name.view(), map);
}

void read_header(TomlTable& table, RegisterMap& map) {
  for (const std::string_view key : {"name", "unit"}) table.require(key);
  FixedText<255> description;
  table.text("name", map.name);
  table.text("description", description);
  table.integer("unit", map.unit, 0, 255);
  table.integer("minimum_gap_ms", map.minimum_gap_ms, 0, 10'000);
  table.integer("response_timeout_ms", map.response_timeout_ms, 10, 30'000);
  table.integer("read_gap_registers_max", map.read_gap_registers_max, 0, 60);
  table.integer("registers_per_read_max", map.registers_per_read_max, 2, 120);
  table.boolean("one_client", map.one_client);
  table.finish();
}

struct PointDefaults {
  std::int32_t read_function = 3;
  int word_order = 0;
};

void read_point(TomlTable& table, const PointDefaults& defaults, RegisterMap& map) {
  RegisterPoint point;
  std::int32_t address = 0;
  std::int32_t read_function = defaults.read_function;
  int type = 0;
  int word_order = defaults.word_order;
  for (const std::string_view key : {"name", "address", "min", "max"}) table.require(key);
  table.text("name", point.name);
  table.text("unit", point.unit);
  table.integer("address", address, 0, 65'535);
  table.integer("read_function", read_function, 3, 4);
  table.choice("type", type, {"u16", "s16", "u32", "s32"});
  table.choice("word_order", word_order, {"high_first", "low_first"});
  table.integer("scale", point.scale, 1, 1'000'000);
  table.integer("scale_divisor", point.scale_divisor, 1, 1'000'000);
  table.integer("offset", point.offset, -kValueLimit, kValueLimit);
  table.integer("sign", point.sign, -1, 1);
  table.integer("min", point.value_min, -kValueLimit * 5, kValueLimit * 5);
  table.integer("max", point.value_max, -kValueLimit * 5, kValueLimit * 5);
  if (point.sign == 0) table.fail("sign", "must be 1 or -1");
  if (point.value_min > point.value_max) table.fail("min", "must not be above max");
  if (find_point(map, point.name.view()) >= 0) table.fail("name", "is used twice");
  point.address = static_cast<std::uint16_t>(address);
  point.read_function = static_cast<std::uint8_t>(read_function);
  point.type = static_cast<RegisterType>(type);
  point.word_order = static_cast<WordOrder>(word_order);
  if (!map.points.try_push_back(point)) {
    table.fail("name",
               "is one point more than the " + std::to_string(map.points.capacity()) + " that fit");
  }
}

bool read_value(TomlTable& table, const toml::node& node, WriteValue& value) {
  if (const auto* number = node.as_integer()) {
    value.constant = number->get();
    return true;
  }
  const auto* name = node.as_string();
  if (name != nullptr && name->get() == "power") {
    value.argument = Argument::kPower;
  } else if (name != nullptr && name->get() == "soc_limit") {
    value.argument = Argument::kSocLimit;
  } else if (name != nullptr && name->get() == "duration") {
    value.argument = Argument::kDuration;
  } else {
    table.fail_at(node, "a value must be a number, \"power\", \"soc_limit\" or \"duration\"");
    return false;
  }
  return true;
}

/// One atomic write: points must lie side by side, in the order given.
void read_write(TomlTable& table, const RegisterMap& map, std::int32_t default_function,
                CommandSequence& sequence) {
  BlockWrite write;
  std::int32_t function = default_function;
  table.require("points");
  table.require("values");
  table.integer("function", function, 6, 16);
  const toml::array* points = table.array("points");
  const toml::array* values = table.array("values");
  if (!table.ok()) return;
  if (points->size() != values->size() || points->empty()) {
    return table.fail("values", "must hold one value for each of the points");
  }
  int next_address = -1;
  for (std::size_t i = 0; i < points->size() && table.ok(); ++i) {
    const auto* name = (*points)[i].as_string();
    if (name == nullptr) return table.fail("points", "must hold point names");
    WriteValue value;
    value.point = point_index(table, (*points)[i], name->get(), map);
    if (value.point < 0 || !read_value(table, (*values)[i], value)) return;
    const RegisterPoint& point = map.points[value.point];
    if (next_address >= 0 && point.address != next_address) {
      return table.fail_at((*points)[i], quoted(name->get()) +
                                             " does not follow the point before it: a block "
                                             "write needs neighbouring registers");
    }
    if (next_address < 0) write.address = point.address;
    next_address = point.address + point.register_count();
    if (!write.values.try_push_back(value)) return table.fail("points", "are too many");
  }
  const int register_count = next_address - write.address;
  if (register_count > kBlockRegistersMax) table.fail("points", "are too many registers");
  if (function != 16 && (function != 6 || register_count != 1)) {
    table.fail("function", "must be 16, or 6 for a single register");
  }
  write.function = static_cast<std::uint8_t>(function);
  if (!sequence.writes.try_push_back(write)) table.fail("points", "is one write too many");
}

void read_sequence(TomlTable& parent, std::string_view key, const RegisterMap& map,
                   std::int32_t function, CommandSequence& sequence) {
  TomlTable table =
      child(parent, parent.table(key), std::string("[variant.").append(key).append("]"));
  sequence = CommandSequence{};
  table.boolean("read_back", sequence.read_back);
  table.require("write");
  for_each_table(table, "write",
                 [&](TomlTable& write) { read_write(write, map, function, sequence); });
  table.finish();
}

/// `order` stands for charge, idle and discharge when they differ only in their arguments.
void read_commands(TomlTable& variant, std::int32_t function, RegisterMap& map) {
  if (variant.has("order")) {
    read_sequence(variant, "order", map, function, map.command[0]);
    map.command[static_cast<int>(Command::kIdle)] = map.command[0];
    map.command[static_cast<int>(Command::kDischarge)] = map.command[0];
  }
  for (int c = 0; c < kCommandCount; ++c) {
    const std::string_view name = kCommandNames[c];
    if (variant.has(name)) read_sequence(variant, name, map, function, map.command[c]);
    static_cast<void>(variant.node(name));  // known keys, whether given or not
    if (variant.ok() && map.command[c].writes.empty()) {
      variant.fail(name, "is missing: every variant commands charge, idle, discharge and release");
    }
  }
  static_cast<void>(variant.node("order"));
}

void read_variants(TomlTable& root, std::string_view wanted, std::int32_t function,
                   RegisterMap& map) {
  std::string names;
  bool found = false;
  for_each_table(root, "variant", [&](TomlTable& variant) {
    RegisterName name;
    FixedText<255> description;
    variant.require("name");
    variant.text("name", name);
    variant.text("description", description);
    names += (names.empty() ? "" : ", ") + std::string(name.view());
    RegisterMap ignored = map;  // variants that are not chosen must be valid all the same
    const bool chosen = !found && (wanted.empty() || name == wanted);
    read_commands(variant, function, chosen ? map : ignored);
    if (chosen) {
      found = true;
      map.variant = name;
    }
  });
  if (!found) {
    root.fail("variant",
              "\"" + std::string(wanted) + "\" does not exist (there are: " + names + ")");
  }
}

void read_limits(TomlTable& root, RegisterMap& map) {
  TomlTable power = child(root, root.table("power"), "[power]");
  power.require("charge_w_max");
  power.require("discharge_w_max");
  power.integer("charge_w_max", map.charge_w_max, 1, kValueLimit);
  power.integer("discharge_w_max", map.discharge_w_max, 1, kValueLimit);
  power.finish();
  TomlTable dead_man = child(root, root.table("dead_man"), "[dead_man]");
  dead_man.integer("duration_s", map.dead_man_duration_s, 0, 86'400);
  read_condition(dead_man, "expired", map, map.dead_man_expired);
  dead_man.finish();
  TomlTable state = child(root, root.table("state"), "[state]");
  read_point_list(state, "measure", map, map.measure);
  read_point_list(state, "alarms", map, map.alarms);
  read_condition(state, "off_grid", map, map.off_grid);
  state.finish();
}

void read_identity(TomlTable& root, RegisterMap& map) {
  for_each_table(root, "identity", [&](TomlTable& table) {
    IdentityCheck check;
    RegisterName name;
    for (const std::string_view key : {"point", "min", "max", "hint"}) table.require(key);
    table.text("point", name);
    table.integer("min", check.value_min, -kValueLimit, kValueLimit);
    table.integer("max", check.value_max, -kValueLimit, kValueLimit);
    table.text("hint", check.hint);
    if (!table.ok()) return;
    check.point = point_index(table, *table.native(), name.view(), map);
    if (!map.identity.try_push_back(check)) table.fail("point", "is one check too many");
  });
}

/// Nothing may wrap later: both ends of the stated power range are encoded once here.
void prove_power_range(TomlTable& root, const RegisterMap& map) {
  for (const std::int32_t power_w : {map.charge_w_max, -map.discharge_w_max, 0}) {
    const PowerOrder order{.power_w = power_w, .duration_s = map.dead_man_duration_s};
    if (check_expressible(map, order) != Status::kOk) {
      root.fail("power",
                "states " + std::to_string(power_w) + " W, which the registers cannot express");
    }
  }
}

}  // namespace

bool load_register_map(const std::string& path, std::string_view variant, RegisterMap& map,
                       std::string& error) {
  toml::table document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  map = RegisterMap{};
  PointDefaults defaults;
  std::int32_t write_function = 16;
  for (const std::string_view key : {"map", "power", "state", "point", "variant"}) {
    root.require(key);
  }
  TomlTable header = child(root, root.table("map"), "[map]");
  header.integer("read_function", defaults.read_function, 3, 4);
  header.integer("write_function", write_function, 6, 16);
  header.choice("word_order", defaults.word_order, {"high_first", "low_first"});
  read_header(header, map);
  for_each_table(root, "point", [&](TomlTable& table) { read_point(table, defaults, map); });
  read_limits(root, map);
  read_identity(root, map);
  read_variants(root, variant, write_function, map);
  root.finish();
  for (const std::string_view name : {"soc", "battery_power"}) {
    if (root.ok() && find_point(map, name) < 0) {
      root.fail("point", quoted(name) + " is missing: the controller needs it");
    }
  }
  if (root.ok()) prove_power_range(root, map);
  return error.empty();
}

}  // namespace bess
