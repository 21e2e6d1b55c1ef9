#include "edge/app/recording/recording_mask.h"

#include <algorithm>

namespace bess {
namespace {

/// Number of characters of a text point that identity checks need.
int asked_characters(const RegisterMap& map, int point) {
  std::size_t most = 0;
  for (const IdentityCheck& check : map.identity) {
    if (check.point == point) most = std::max(most, check.text.view().size());
  }
  return static_cast<int>(most);
}

/// Padding of a text stays unchanged.
std::uint16_t hidden_character(std::uint16_t character) {
  return character == 0 || character == ' ' ? character : std::uint16_t{'X'};
}

}  // namespace

void RecordingMask::apply(BusExchange& exchange) {
  places_.follow(exchange);
  if (places_.is_model_head()) return;
  BusExchange kept = exchange;
  kept.registers.fill(0);
  for (int i = 0; i < map_.points.size(); ++i) {
    const RegisterPoint& point = map_.points[i];
    const int offset = places_.offset_in(exchange, i);
    if (offset < 0 || point.is_private) continue;
    if (point.type == RegisterType::kText) {
      keep_text(exchange, i, offset, kept);
    } else {
      std::copy_n(exchange.registers.begin() + offset, point.registers,
                  kept.registers.begin() + offset);
    }
  }
  // Two points may share a register: private wins.
  for (int i = 0; i < map_.points.size(); ++i) {
    const int offset = map_.points[i].is_private ? places_.offset_in(exchange, i) : -1;
    if (offset < 0) continue;
    std::fill_n(kept.registers.begin() + offset, map_.points[i].registers, std::uint16_t{0});
  }
  exchange = kept;
}

void RecordingMask::keep_text(const BusExchange& exchange, int point, int offset,
                              BusExchange& kept) const {
  const RegisterPoint& p = map_.points[point];
  const int asked = asked_characters(map_, point);
  for (int i = 0; i < p.registers; ++i) {
    const int word = p.word_order == WordOrder::kHighFirst ? i : p.registers - 1 - i;
    const auto at = static_cast<std::size_t>(offset) + static_cast<std::size_t>(word);
    const std::uint16_t raw = exchange.registers[at];
    auto high = static_cast<std::uint16_t>(raw >> 8);
    auto low = static_cast<std::uint16_t>(raw & 0xFF);
    if (2 * i >= asked) high = hidden_character(high);
    if (2 * i + 1 >= asked) low = hidden_character(low);
    kept.registers[at] = static_cast<std::uint16_t>(high << 8 | low);
  }
}

}  // namespace bess
