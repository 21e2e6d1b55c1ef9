// What the registers of a battery mean by its maker's documents, written down a second time and by
// hand: the sources are those that edge/maps/*.toml name, read again; the maps themselves are not.
// A sign, a word order or a scale that map or interpreter get wrong is wrong for the edge and for
// bess-sim alike, which have them in common; not here.
#pragma once

#include <optional>
#include <string_view>

#include "tools/hil_runner/witness/wire_memory.h"

namespace bess {

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
