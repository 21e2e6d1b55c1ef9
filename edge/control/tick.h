// The grid of decisions: a tick is a multiple of 2 minutes UTC, and what belongs to one ends with
// it.
#pragma once

#include <cstdint>

#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

constexpr std::int64_t next_tick_utc_s(std::int64_t now_utc_s) {
  return (now_utc_s / kSecondsPerStep + 1) * kSecondsPerStep;
}

/// The instant in monotonic time, at most `longest_s` from now: to a clock that was stepped back
/// the tick lies far ahead.
template <typename Clock>
std::int64_t bounded_monotonic_ns(Clock& clock, std::int64_t utc_s, std::int64_t longest_s) {
  const std::int64_t longest_ns = clock.now_utc_ns() + longest_s * kNanosecondsPerSecond;
  const std::int64_t utc_ns = utc_s * kNanosecondsPerSecond;
  return clock.monotonic_ns_at(utc_ns < longest_ns ? utc_ns : longest_ns);
}

/// UTC as it would be, had nobody stepped the clock since this was made: for how long something
/// took.
template <typename Clock>
class SteadyTime {
 public:
  explicit SteadyTime(const Clock& clock)
      : clock_(clock),
        start_utc_ns_(clock.now_utc_ns()),
        start_monotonic_ns_(clock.monotonic_ns_at(start_utc_ns_)) {}

  [[nodiscard]] std::int64_t now_s() const {
    const std::int64_t stepped_ns = start_monotonic_ns_ - clock_.monotonic_ns_at(start_utc_ns_);
    return (clock_.now_utc_ns() - stepped_ns) / kNanosecondsPerSecond + ahead_s_;
  }
  /// Before it is asked.
  void set_ahead(std::int64_t ahead_s) { ahead_s_ = ahead_s; }

 private:
  const Clock& clock_;
  std::int64_t start_utc_ns_;
  std::int64_t start_monotonic_ns_;
  std::int64_t ahead_s_ = 0;
};

}  // namespace bess
