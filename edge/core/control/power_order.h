// Set point in project units: the interface between control and register codec.
#pragma once

#include <cstdint>

namespace bess {

struct PowerOrder {
  std::int32_t power_w = 0;  ///< grid side, charge positive
  std::int32_t soc_min_e4 = 0;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t duration_s = 0;  ///< until the device's watchdog ends it
  /// CLOCK_MONOTONIC instants. No write after the first: a process that was suspended must not act
  /// on an old decision. No watchdog refresh after the second.
  std::int64_t write_until_ns = INT64_MAX;
  std::int64_t feed_until_ns = INT64_MAX;
};

}  // namespace bess
