// Phrases of a map: "point = value", "point has bit".
#include <bit>
#include <charconv>

#include "edge/device/registers/map_reader.h"

namespace bess {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool parse_number(std::string_view text, std::int64_t& value) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const bool hex = text.starts_with("0x");
  if (hex) text.remove_prefix(2);
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hex ? 16 : 10);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return false;
  if (negative) value = -value;
  return value >= -kMapValueLimit && value <= kMapValueLimit;
}

}  // namespace

MapPhrase split_phrase(std::string_view text) {
  for (const std::string_view op : {"!=", "=", " has "}) {
    const std::size_t at = text.find(op);
    if (at == std::string_view::npos) continue;
    return {trimmed(text.substr(0, at)), trimmed(op), trimmed(text.substr(at + op.size()))};
  }
  return {trimmed(text), {}, {}};
}

std::int8_t require_point(TomlTable& table, const TomlValue& at, std::string_view name,
                          const RegisterMap& map) {
  const int index = find_point(map, name);
  if (index < 0) table.fail_at(at, "no [[point]] is named " + quoted(name));
  return static_cast<std::int8_t>(index);
}

bool parse_value(const RegisterMap& map, int point, std::string_view text, std::int64_t& value) {
  for (const NamedValue& named : map.names) {
    if (named.point != point || named.name != text) continue;
    value = named.value;
    return true;
  }
  return parse_number(text, value);
}

namespace {

/// Bits that a reading of the point can contain, given its mask, registers and range.
std::uint64_t readable_bits(const RegisterPoint& point) {
  const int width = 16 * point.registers;
  const std::uint64_t all = point.mask != 0 ? point.mask >> std::countr_zero(point.mask)
                            : width >= 64   ? ~0ULL
                                            : (1ULL << width) - 1;
  if (point.value_min < 0) return all;  // negative numbers have the high bits set
  return all & (std::bit_ceil(static_cast<std::uint64_t>(point.value_max) + 1) - 1);
}

/// Rejects a condition that no reading can fulfil: a fault would never show.
void check_can_hold(TomlTable& table, const TomlValue& at, const RegisterMap& map,
                    const Condition& condition, std::string_view text) {
  const RegisterPoint& point = map.points[condition.point];
  const std::string name = quoted(point.name.view());
  const std::string range =
      std::to_string(point.value_min) + " to " + std::to_string(point.value_max);
  if (condition.test == Condition::Test::kHasBits) {
    const auto bits = static_cast<std::uint64_t>(condition.value);
    if (bits != 0 && (bits & ~readable_bits(point)) == 0) return;
    return table.fail_at(at, quoted(text) + " can never hold: " + name + ", " + range +
                                 (bits == 0 ? ", no bit is given" : ", has no such bit"));
  }
  const bool is_read = condition.value >= point.value_min && condition.value <= point.value_max;
  if (condition.test != Condition::Test::kEqual || is_read) return;
  table.fail_at(at, quoted(text) + " can never hold: " + name + " is " + range);
}

}  // namespace

void parse_condition(TomlTable& table, const TomlValue& at, std::string_view text,
                     const RegisterMap& map, Condition& condition) {
  const MapPhrase phrase = split_phrase(text);
  condition.point = require_point(table, at, phrase.left, map);
  if (condition.point < 0) return;
  condition.test = phrase.op == "="     ? Condition::Test::kEqual
                   : phrase.op == "has" ? Condition::Test::kHasBits
                                        : Condition::Test::kNotEqual;
  if (phrase.op.empty()) return;  // "point" alone: not 0
  if (parse_value(map, condition.point, phrase.right, condition.value)) {
    return check_can_hold(table, at, map, condition, text);
  }
  table.fail_at(at,
                quoted(phrase.right) + " is neither a number nor a name of " + quoted(phrase.left));
}

}  // namespace bess
