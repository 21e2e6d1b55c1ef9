// SoC bounds of the guard with hysteresis, which prevents alternating orders at a bound.
#pragma once

#include <cstdint>

namespace bess {

struct SocLatches {
  std::int32_t min_e4, max_e4, hysteresis_e4;
  bool is_full = false;   ///< closed for charging
  bool is_empty = false;  ///< closed for discharging

  constexpr void update(std::int32_t soc_e4) {
    if (soc_e4 >= max_e4) is_full = true;
    if (soc_e4 < max_e4 - hysteresis_e4) is_full = false;
    if (soc_e4 <= min_e4) is_empty = true;
    if (soc_e4 > min_e4 + hysteresis_e4) is_empty = false;
  }
};

}  // namespace bess
