// Scaled UTC clock, common to edge, battery and market simulators, so that a day takes two minutes.
// All processes of one machine agree because they share CLOCK_MONOTONIC. scale = 1 and a zero
// anchor: real time from CLOCK_REALTIME.
#pragma once

#include <time.h>

#include <cstdint>

namespace bess {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

inline std::int64_t clock_ns(clockid_t id) {
  timespec t{};
  clock_gettime(id, &t);
  return std::int64_t{t.tv_sec} * kNanosecondsPerSecond + t.tv_nsec;
}

struct ScaledClock {
  std::int64_t anchor_monotonic_ns = 0;  ///< wall instant (CLOCK_MONOTONIC) of anchor_utc_s
  std::int64_t anchor_utc_s = 0;
  std::int32_t scale = 1;  ///< simulated seconds per wall second

  [[nodiscard]] bool is_real_time() const { return scale == 1 && anchor_monotonic_ns == 0; }

  /// Simulated (or real) UTC in nanoseconds since 1970.
  [[nodiscard]] std::int64_t now_utc_ns() const {
    if (is_real_time()) return clock_ns(CLOCK_REALTIME);
    return anchor_utc_s * kNanosecondsPerSecond +
           (clock_ns(CLOCK_MONOTONIC) - anchor_monotonic_ns) * scale;
  }
  /// Start time of a process: not before the anchor, the begin of simulated time.
  [[nodiscard]] std::int64_t start_utc_ns() const {
    const std::int64_t anchor_utc_ns = anchor_utc_s * kNanosecondsPerSecond;
    const std::int64_t now_ns = now_utc_ns();
    return !is_real_time() && now_ns < anchor_utc_ns ? anchor_utc_ns : now_ns;
  }
  /// CLOCK_MONOTONIC instant at which the simulated clock shows `utc_ns`.
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    if (is_real_time()) return clock_ns(CLOCK_MONOTONIC) + utc_ns - clock_ns(CLOCK_REALTIME);
    return anchor_monotonic_ns + (utc_ns - anchor_utc_s * kNanosecondsPerSecond) / scale;
  }
  /// Wall time of a simulated duration, ns.
  [[nodiscard]] std::int64_t wall_ns(std::int64_t simulated_ns) const {
    return simulated_ns / scale;
  }
};

/// UTC of any clock with now_utc_ns(), in whole seconds since 1970.
template <typename Clock>
std::int64_t utc_seconds(Clock& clock) {
  return clock.now_utc_ns() / kNanosecondsPerSecond;
}

/// Sleeps until a CLOCK_MONOTONIC instant; returns immediately if it has passed. True when the
/// instant was reached, false when interrupted by a signal.
inline bool sleep_until_monotonic(std::int64_t monotonic_ns) {
  timespec t{.tv_sec = static_cast<time_t>(monotonic_ns / kNanosecondsPerSecond),
             .tv_nsec = static_cast<long>(monotonic_ns % kNanosecondsPerSecond)};
  return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == 0;
}

}  // namespace bess
