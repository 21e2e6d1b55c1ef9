#include "tools/hil_runner/witness/wire_memory.h"

namespace bess {
namespace {

constexpr std::uint8_t kReadHolding = 3;
constexpr std::uint8_t kReadInput = 4;
constexpr std::uint8_t kWriteOne = 6;
constexpr std::uint8_t kWriteMany = 16;

int word_at(WireMemory::Frame bytes, std::size_t at) { return bytes[at] * 256 + bytes[at + 1]; }

}  // namespace

bool WireMemory::exchanged(Frame request, Frame answer) {
  if (request.size() < 6 || answer.size() < 3 || answer[1] != request[1]) return false;
  const int unit = request[0];
  const int address = word_at(request, 2);
  switch (request[1]) {
    case kReadHolding:
    case kReadInput: {
      const auto table = request[1] == kReadInput ? Table::kInput : Table::kHolding;
      if (answer.size() < 3U + answer[2]) return false;
      keep(unit, table, address, answer.subspan(3, answer[2]));
      return true;
    }
    case kWriteOne:
      keep(unit, Table::kHolding, address, request.subspan(4, 2));
      return true;
    case kWriteMany:
      if (request.size() < 7U + request[6]) return false;
      keep(unit, Table::kHolding, address, request.subspan(7, request[6]));
      return true;
    default:
      return false;
  }
}

void WireMemory::keep(int unit, Table table, int address, Frame words) {
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    words_[{unit, table, address++}] = static_cast<std::uint16_t>(word_at(words, i));
  }
}

std::optional<std::uint16_t> WireMemory::word(int unit, int address, Table table) const {
  const auto found = words_.find({unit, table, address});
  if (found == words_.end()) return std::nullopt;
  return found->second;
}

std::optional<double> WireMemory::signed16(int unit, int address, Table table) const {
  const auto value = word(unit, address, table);
  if (!value) return std::nullopt;
  return *value < 0x8000 ? *value : *value - 0x1'0000;
}

std::optional<double> WireMemory::unsigned32(int unit, int address, Table table) const {
  const auto high = word(unit, address, table);
  const auto low = word(unit, address + 1, table);
  if (!high || !low) return std::nullopt;
  return 65'536.0 * *high + *low;
}

std::optional<double> WireMemory::signed32(int unit, int address, Table table) const {
  const auto value = unsigned32(unit, address, table);
  if (!value) return std::nullopt;
  return *value < 2'147'483'648.0 ? *value : *value - 4'294'967'296.0;
}

}  // namespace bess
