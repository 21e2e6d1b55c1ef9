// Map section [command]: every command as an ordered list of steps. A step is one request:
//   "point = value"                     one write
//   ["point = value", "point = value"]  one atomic write of neighbouring registers
//   { write = ..., function = 6, read_back = "tolerance", tolerance = 50 }
#include "edge/device/registers/map_reader.h"
#include "edge/device/registers/point_codec.h"

namespace bess {
namespace {

struct NamedArgument {
  std::string_view name;
  Argument argument;
};

constexpr NamedArgument kArguments[] = {{"power", Argument::kPower},
                                        {"charge_power", Argument::kChargePower},
                                        {"discharge_power", Argument::kDischargePower},
                                        {"soc_limit", Argument::kSocLimit},
                                        {"soc_min", Argument::kSocMin},
                                        {"soc_max", Argument::kSocMax},
                                        {"duration", Argument::kDuration},
                                        {"duration_minutes", Argument::kDurationMinutes},
                                        {"heartbeat", Argument::kHeartbeat},
                                        {"rating", Argument::kRating},
                                        {"saved", Argument::kSaved}};

std::string argument_names() {
  std::string names;
  for (const NamedArgument& known : kArguments) {
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  return names;
}

/// "[-] argument [/ whole number]", followed by "+ point"
bool parse_argument(std::string_view text, WriteValue& value) {
  if (text.starts_with('-')) {
    value.sign = -1;
    text.remove_prefix(1);
  }
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    std::string_view divisor = text.substr(slash + 1);
    while (divisor.starts_with(' ')) divisor.remove_prefix(1);
    if (divisor.size() != 1 || divisor[0] < '2' || divisor[0] > '9') return false;
    value.divisor = static_cast<std::uint8_t>(divisor[0] - '0');
    text = text.substr(0, slash);
    while (text.ends_with(' ')) text.remove_suffix(1);
  }
  for (const NamedArgument& known : kArguments) {
    if (known.name != text) continue;
    value.argument = known.argument;
    return true;
  }
  return false;
}

void parse_assignment(TomlTable& table, const TomlValue& at, std::string_view text,
                      const RegisterMap& map, WriteValue& value) {
  const MapPhrase phrase = split_phrase(text);
  if (phrase.op != "=") return table.fail_at(at, "a step must be \"point = value\"");
  value.point = require_point(table, at, phrase.left, map);
  if (value.point < 0) return;
  std::string_view written = phrase.right;
  constexpr std::string_view kPlus = " + ";
  if (const std::size_t plus = written.find(kPlus); plus != std::string_view::npos) {
    value.plus = require_point(table, at, written.substr(plus + kPlus.size()), map);
    if (value.plus < 0) return;
    written = written.substr(0, plus);
  }
  if (parse_value(map, value.point, written, value.constant)) return;
  value.constant = 0;
  if (!parse_argument(written, value)) {
    return table.fail_at(at, quoted(written) + " is neither a number, nor a name of " +
                                 quoted(phrase.left) + ", nor one of: " + argument_names());
  }
  if (value.argument == Argument::kRating && map.points[value.point].percent_of < 0) {
    table.fail_at(at, "\"rating\" needs a point with percent_of");
  }
}

/// Points of one request must be adjacent, in the order given.
void append_value(TomlTable& table, const TomlValue& at, const RegisterMap& map,
                  const WriteValue& value, BlockWrite& write) {
  const RegisterPoint& point = map.points[value.point];
  if (!write.values.empty()) {
    const RegisterPoint& before = map.points[write.values[write.values.size() - 1].point];
    if (point.address != before.address + before.registers || point.model != before.model ||
        point.unit_group != before.unit_group) {
      return table.fail_at(at, quoted(point.name.view()) +
                                   " does not follow the previous point: a block write needs "
                                   "neighbouring registers");
    }
  }
  if (point.mask != 0 || point.type == RegisterType::kText) {
    return table.fail_at(
        at, quoted(point.name.view()) + " cannot be written: text and bit fields are read-only");
  }
  if (!write.values.try_push_back(value)) table.fail_at(at, "too many points for one write");
}

void finish_write(TomlTable& table, const TomlValue& at, const RegisterMap& map,
                  BlockWrite& write) {
  int registers = 0;
  for (const WriteValue& value : write.values) {
    const RegisterPoint& point = map.points[value.point];
    registers += point.registers;
    write.eeprom = write.eeprom || point.eeprom;
  }
  if (registers == 0) return table.fail_at(at, "a write needs at least one \"point = value\"");
  if (registers > kBlockRegistersMax) table.fail_at(at, "too many registers for one write");
  if (write.function == 6 && registers != 1) table.fail_at(at, "function 6 writes one register");
}

void read_values(TomlTable& table, const TomlValue& node, const RegisterMap& map,
                 BlockWrite& write) {
  const auto read_one = [&](const TomlValue& item) {
    const auto* text = item.as<std::string>();
    WriteValue value;
    if (text == nullptr) return table.fail_at(item, "a step must be \"point = value\"");
    parse_assignment(table, item, *text, map, value);
    if (table.ok()) append_value(table, item, map, value, write);
  };
  if (const auto* list = node.as<TomlArray>()) {
    for (const TomlValue& item : *list) read_one(item);
  } else {
    read_one(node);
  }
}

/// A default of 6 means: single registers by function 6, blocks by 16.
std::uint8_t default_function(const RegisterMap& map, const BlockWrite& write,
                              const MapDefaults& defaults) {
  const bool single = write.values.size() == 1 && map.points[write.values[0].point].registers == 1;
  return defaults.write_function == 6 && single ? 6 : 16;
}

void read_write(TomlTable& table, const TomlValue& node, const MapDefaults& defaults,
                const RegisterMap& map, CommandSequence& sequence) {
  BlockWrite write;
  const bool has_options = node.as<TomlMembers>() != nullptr;
  TomlTable step{&node, table.file(), "write", table.error()};
  const TomlValue* values = has_options ? step.node("write") : &node;
  if (values == nullptr) return step.require("write");
  read_values(table, *values, map, write);
  if (!table.ok() || write.values.empty()) return finish_write(table, node, map, write);
  write.function = default_function(map, write, defaults);
  if (has_options) {
    step.integer("function", write.function, 6, 16);
    step.choice("read_back", write.read_back, {"exact", "tolerance", "none"});
    step.integer("tolerance", write.tolerance, 1, 1'000'000);
    if (write.function != 6 && write.function != 16) step.fail("function", "must be 6 or 16");
    if (write.read_back == ReadBack::kTolerance) step.require("tolerance");
    step.finish();
  }
  finish_write(table, node, map, write);
  if (!sequence.writes.try_push_back(write)) table.fail_at(node, "exceeds the limit of 8 writes");
}

void read_sequence(TomlTable& table, std::string_view key, const MapDefaults& defaults,
                   const RegisterMap& map, CommandSequence& sequence) {
  const TomlValue* node = table.node(key);
  if (node == nullptr) return;
  const auto* steps = node->as<TomlArray>();
  if (steps == nullptr) return table.fail(key, "must be a list of steps in [ ]");
  for (const TomlValue& step : *steps) {
    read_write(table, step, defaults, map, sequence);
    if (!table.ok()) return;
  }
}

void read_saved(TomlTable& table, RegisterMap& map) {
  for_each_text(table, "save", [&](std::string_view text, const TomlValue& at) {
    const MapPhrase phrase = split_phrase(text);
    SavedPoint saved{.point = require_point(table, at, phrase.left, map)};
    if (saved.point < 0) return;
    if (phrase.op != "=" || !parse_value(map, saved.point, phrase.right, saved.fallback)) {
      return table.fail_at(at, "save must be \"point = value to restore if unknown\"");
    }
    if (!map.saved.try_push_back(saved)) table.fail("save", "holds too many points");
  });
}

}  // namespace

void read_map_commands(TomlTable& root, const MapDefaults& defaults, RegisterMap& map) {
  constexpr std::string_view kNames[kCommandCount] = {"charge",  "idle",   "discharge",
                                                      "release", "enable", "refresh"};
  TomlTable table = root.child("command");
  read_saved(table, map);
  read_conditions(table, "precondition", map, map.precondition);
  if (table.has("order")) {  // they differ only in their arguments
    read_sequence(table, "order", defaults, map, map.command[0]);
    map.command[1] = map.command[2] = map.command[0];
  }
  static_cast<void>(table.node("order"));
  for (int c = 0; c < kCommandCount; ++c) {
    if (table.has(kNames[c])) {
      map.command[c] = CommandSequence{};
      read_sequence(table, kNames[c], defaults, map, map.command[c]);
    }
    static_cast<void>(table.node(kNames[c]));  // marks the key as known
    const bool required = c <= static_cast<int>(Command::kRelease);
    if (required && table.ok() && map.command[c].writes.empty()) {
      table.fail(kNames[c], "is missing: a map needs charge, idle, discharge and release");
    }
  }
  table.finish();
}

}  // namespace bess
