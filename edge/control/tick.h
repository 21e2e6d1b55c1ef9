// The grid of decisions: a tick is a multiple of 2 minutes UTC, and what belongs to one ends with it.
#pragma once

#include <cstdint>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

constexpr std::int64_t next_tick_utc_s(std::int64_t now_utc_s) {
  return (now_utc_s / kSecondsPerStep + 1) * kSecondsPerStep;
}

/// The instant in monotonic time, at most `longest_s` from now: to a clock that was stepped back the
/// tick lies far ahead.
template <typename Clock>
std::int64_t bounded_monotonic_ns(Clock& clock, std::int64_t utc_s, std::int64_t longest_s) {
  const std::int64_t longest_ns = clock.now_utc_ns() + longest_s * kNanosecondsPerSecond;
  const std::int64_t utc_ns = utc_s * kNanosecondsPerSecond;
  return clock.monotonic_ns_at(utc_ns < longest_ns ? utc_ns : longest_ns);
}

}  // namespace bess
