// What somebody who knows only the maker's table of registers reads off the wire, at one instant.
#pragma once

#include <cstdint>
#include <optional>

namespace bess {

struct WireReading {
  std::int64_t utc_ns = 0;
  std::optional<double> soc_frac;   ///< as the device shows it
  std::optional<double> power_w;    ///< likewise, charge positive
  std::optional<double> ordered_w;  ///< as written; nothing: no order stands in the registers

  [[nodiscard]] bool shows_the_same(const WireReading& other) const {
    return soc_frac == other.soc_frac && power_w == other.power_w && ordered_w == other.ordered_w;
  }
};

}  // namespace bess
