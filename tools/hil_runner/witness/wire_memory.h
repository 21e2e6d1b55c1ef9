// Every register that was read or written on a bus, as it was last seen there. It takes the frames
// apart by itself: no code and no table is shared with what drives the battery, or with what acts
// it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>

namespace bess {

/// The protocol's two kinds, by the function that reads them.
enum class Table : std::uint8_t { kHolding = 3, kInput = 4 };

class WireMemory {
 public:
  using Frame = std::span<const std::uint8_t>;
  /// A request and its answer, both from the unit's byte on. False: an exception, or no reading and
  /// no writing.
  bool exchanged(Frame request, Frame answer);

  [[nodiscard]] std::optional<std::uint16_t> word(int unit, int address,
                                                  Table table = Table::kHolding) const;
  [[nodiscard]] std::optional<double> signed16(int unit, int address,
                                               Table table = Table::kHolding) const;
  /// Two registers, the high word first.
  [[nodiscard]] std::optional<double> unsigned32(int unit, int address,
                                                 Table table = Table::kHolding) const;
  [[nodiscard]] std::optional<double> signed32(int unit, int address,
                                               Table table = Table::kHolding) const;

 private:
  void keep(int unit, Table table, int address, Frame words);

  std::map<std::tuple<int, Table, int>, std::uint16_t> words_;
};

}  // namespace bess
