// What the registers of a battery mean by its maker's documents, written down a second time and by
// hand: the sources are those that edge/device/maps/*.toml name, read again; the maps themselves
// are not. A sign, a word order or a scale that map or interpreter get wrong is wrong for the edge
// and for bess-sim alike, which have them in common; not here.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>

namespace bess {

// Every register that was read or written on a bus, as it was last seen there. It takes the frames
// apart by itself: no code and no table is shared with what drives the battery, or with what acts
// it.

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

class MakerTable {
 public:
  using Value = std::optional<double>;

  virtual ~MakerTable() = default;
  [[nodiscard]] virtual Value soc_frac(const WireMemory& wire) const = 0;
  [[nodiscard]] virtual Value power_w(const WireMemory& wire) const = 0;
  /// Nothing while no order stands in the registers. 0 W is an order.
  [[nodiscard]] virtual Value ordered_w(const WireMemory& wire) const = 0;
};

/// Of a map by its name; null: nobody has written one down.
const MakerTable* maker_table(std::string_view map, std::string_view variant);

}  // namespace bess
