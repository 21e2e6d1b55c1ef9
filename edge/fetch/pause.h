// Waiting in a thread of bess-prices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stop_token>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

/// So long by the wall, or until a stop is requested, a tenth of a second later at most.
inline void pause(std::int64_t wall_ns, const std::stop_token& stop) {
  constexpr std::int64_t kSliceNs = kNanosecondsPerSecond / 10;
  for (; wall_ns > 0 && !stop.stop_requested(); wall_ns -= kSliceNs) {
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + std::min(wall_ns, kSliceNs));
  }
}

}  // namespace bess
