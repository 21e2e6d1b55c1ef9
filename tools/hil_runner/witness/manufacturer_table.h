// Manufacturer register tables, written by hand and independently of the maps, from the documents
// that edge/device/maps/*.toml name. They detect errors of sign, word order or scale in maps and
// interpreter, which edge and bess-sim have in common.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>

namespace bess {

// Last value of each register read or written on a bus. The decoder shares no code and no table
// with the edge or the simulator.

/// Register kinds, by read function.
enum class Table : std::uint8_t { kHolding = 3, kInput = 4 };

class WireMemory {
 public:
  using Frame = std::span<const std::uint8_t>;
  /// Request and answer, both from the unit byte on. False: an exception, or neither read nor
  /// write.
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

struct ManufacturerTable {
  using Value = std::optional<double>;

  std::string_view map, variant;
  Value (*soc_frac)(const WireMemory& wire);
  Value (*power_w)(const WireMemory& wire);
  /// Empty without an order in the registers. 0 W is an order.
  Value (*ordered_w)(const WireMemory& wire);
};

/// Table of a map by its name; null: none.
const ManufacturerTable* manufacturer_table(std::string_view map, std::string_view variant);

}  // namespace bess
