// The control loop's clock in the trial: it jumps from deadline to deadline.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/scaled_clock.h"

namespace bess::trial {

struct TrialClock {
  std::int64_t now_ns = 0;

  [[nodiscard]] std::int64_t now_utc_ns() const { return now_ns; }
  [[nodiscard]] std::int64_t now_utc_s() const { return now_ns / kNanosecondsPerSecond; }
  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns; }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const { return utc_ns; }
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    now_ns = std::max(now_ns, utc_ns);
    return true;
  }
  void pause_ns(std::int64_t ns) { now_ns += ns; }
  [[nodiscard]] static bool stop_requested() { return false; }
  [[nodiscard]] static bool is_synchronised() { return true; }
};

}  // namespace bess::trial
