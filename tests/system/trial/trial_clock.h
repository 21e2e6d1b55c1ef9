// Clock of the control loop in the trial: it jumps from deadline to deadline.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "shared/scaled_clock.h"

namespace bess::trial {

struct TrialClock {
  std::int64_t now_ns = 0;      ///< the true time
  std::int64_t stepped_ns = 0;  ///< offset of the machine's clock
  std::int64_t step_at_ns = 0;
  std::int64_t step_ns = 0;  ///< 0 = none is due

  [[nodiscard]] std::int64_t true_utc_s() const { return now_ns / kNanosecondsPerSecond; }
  [[nodiscard]] std::int64_t now_utc_ns() const { return now_ns + stepped_ns; }
  [[nodiscard]] std::int64_t now_utc_s() const { return now_utc_ns() / kNanosecondsPerSecond; }
  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns; }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return utc_ns - stepped_ns;
  }
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    if (step_ns != 0 && step_at_ns <= utc_ns - stepped_ns) {
      now_ns = std::max(now_ns, step_at_ns);
      stepped_ns += std::exchange(step_ns, 0);
      if (utc_ns - stepped_ns > now_ns + 5 * kNanosecondsPerSecond) return true;  // as EdgeClock
    }
    now_ns = std::max(now_ns, utc_ns - stepped_ns);
    return true;
  }
  /// In the first sleep of at least this length.
  void step_after(std::int64_t after_s, std::int64_t step_s) {
    step_at_ns = now_ns + after_s * kNanosecondsPerSecond;
    step_ns = step_s * kNanosecondsPerSecond;
  }
  void pause_ns(std::int64_t ns) { now_ns += ns; }
  [[nodiscard]] static bool stop_requested() { return false; }
  [[nodiscard]] static bool is_synchronised() { return true; }
};

}  // namespace bess::trial
