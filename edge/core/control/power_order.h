// What the controller wants of the battery, in the project's own units: the word that control
// passes down to the register codec, which knows how a device says it.
#pragma once

#include <cstdint>

namespace bess {

struct PowerOrder {
  std::int32_t power_w = 0;  ///< grid side, charge positive
  std::int32_t soc_min_e4 = 0;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t duration_s = 0;  ///< until the device's watchdog ends it
  /// CLOCK_MONOTONIC instants. Nothing of it is written after the first: a process that was stopped
  /// must not go on with what it decided before. After the second it is not fed any more.
  std::int64_t write_until_ns = INT64_MAX;
  std::int64_t feed_until_ns = INT64_MAX;
};

}  // namespace bess
