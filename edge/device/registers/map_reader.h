// Map reader: parts of the register map loader in the order of load_register_map. Later parts refer
// to points read by earlier ones. Start-up only.
#pragma once

#include <string>
#include <string_view>

#include "edge/device/registers/register_map.h"
#include "shared/host/toml_reader.h"

namespace bess {

inline constexpr std::int64_t kMapValueLimit = 5'000'000'000;

/// Defaults of [map] for all points and writes.
struct MapDefaults {
  std::uint8_t read_function = 3;
  std::int32_t write_function = 16;
  std::int32_t address_base = 0;
  WordOrder word_order = WordOrder::kHighFirst;
  int not_implemented = 0;  ///< by type: 0 = none, 1 = SunSpec's raw value, 2 = both extremes
};

void read_map_header(TomlTable& root, RegisterMap& map, MapDefaults& defaults);
void read_map_points(TomlTable& root, const MapDefaults& defaults, RegisterMap& map);
void read_map_limits(TomlTable& root, RegisterMap& map);
void read_map_watchdog(TomlTable& root, RegisterMap& map);
void read_map_state(TomlTable& root, RegisterMap& map);
void read_map_identity(TomlTable& root, RegisterMap& map);
void read_map_commands(TomlTable& root, const MapDefaults& defaults, RegisterMap& map);
void read_map_policies(TomlTable& root, RegisterMap& map);
void read_map_simulator(TomlTable& root, RegisterMap& map);
/// Checks of the whole map: everything the controller relies on is present and provable.
void check_map(TomlTable& root, RegisterMap& map);

inline std::string quoted(std::string_view name) {
  return std::string("\"").append(name).append("\"");
}

/// Calls `read` for each table of the list `key`, e.g. [[point]].
template <typename Function>
void for_each_table(TomlTable& parent, std::string_view key, Function read) {
  const TomlArray* list = parent.array(key);
  if (list == nullptr) return;
  for (const TomlValue& item : *list) {
    if (item.as<TomlMembers>() == nullptr)
      return parent.fail_at(item, std::string(key) + " must hold tables");
    TomlTable table{&item, parent.file(), std::string("[[").append(key).append("]]"),
                    parent.error()};
    read(table);
    table.finish();
  }
}

/// Calls `read(text, node)` for each text of the list `key`, or for its single text.
template <typename Function>
void for_each_text(TomlTable& table, std::string_view key, Function read) {
  const TomlValue* node = table.node(key);
  if (node == nullptr) return;
  if (const auto* text = node->as<std::string>()) return read(std::string_view(*text), *node);
  const auto* list = node->as<TomlArray>();
  if (list == nullptr) return table.fail(key, "must be text or a list of texts");
  for (const TomlValue& item : *list) {
    const auto* text = item.as<std::string>();
    if (text == nullptr) return table.fail_at(item, std::string(key) + " must hold texts");
    read(std::string_view(*text), item);
  }
}

/// Reads a list of numbers such as models = [124, 704].
template <typename T, int kCapacity>
void read_numbers(TomlTable& table, std::string_view key, std::int64_t min, std::int64_t max,
                  StaticVector<T, kCapacity>& out) {
  const TomlArray* list = table.array(key);
  if (list == nullptr) return;
  for (const TomlValue& item : *list) {
    const auto* number = item.as<std::int64_t>();
    if (number == nullptr || *number < min || *number > max) {
      return table.fail_at(item, std::string(key) + " must hold whole numbers from " +
                                     std::to_string(min) + " to " + std::to_string(max));
    }
    if (!out.try_push_back(static_cast<T>(*number))) {
      return table.fail(key, "holds more than " + std::to_string(kCapacity) + " numbers");
    }
  }
}

/// "left op right" with op one of =, != and has; op and right are empty without one.
struct MapPhrase {
  std::string_view left, op, right;
};
MapPhrase split_phrase(std::string_view text);

/// Index of a point; -1 with the error set if it does not exist.
std::int8_t require_point(TomlTable& table, const TomlValue& at, std::string_view name,
                          const RegisterMap& map);
/// "point", or a list of { when = "condition", power = "point" or a list of points to add up }.
void read_power_cases(TomlTable& table, std::string_view key, const RegisterMap& map,
                      StaticVector<PowerCase, 4>& cases);
/// A number, or one of the point's names for values or bits.
bool parse_value(const RegisterMap& map, int point, std::string_view text, std::int64_t& value);
/// "point = value", "point != value", "point has bit", or "point" alone for "point != 0".
void parse_condition(TomlTable& table, const TomlValue& at, std::string_view text,
                     const RegisterMap& map, Condition& condition);

template <int kCapacity>
void read_conditions(TomlTable& table, std::string_view key, const RegisterMap& map,
                     StaticVector<Condition, kCapacity>& out) {
  for_each_text(table, key, [&](std::string_view text, const TomlValue& at) {
    Condition condition;
    parse_condition(table, at, text, map, condition);
    if (!out.try_push_back(condition)) table.fail(key, "holds too many conditions");
  });
}

}  // namespace bess
