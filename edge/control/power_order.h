// What the controller wants of the battery, in the project's own units: the word that control passes down
// to the register codec, which knows how a device says it.
#pragma once

#include <cstdint>

namespace bess {

struct PowerOrder {
  std::int32_t power_w = 0;  ///< grid side, charge positive
  std::int32_t soc_min_e4 = 0;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t duration_s = 0;  ///< until the device's watchdog ends it
};

}  // namespace bess
