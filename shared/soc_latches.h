// The SoC's bounds as the guard keeps them: a direction that one of them has closed opens again
// only some way back inside, or orders would flicker there.
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
