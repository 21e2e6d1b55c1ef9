// The simulated clock that all programs of a site share.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <vector>

#include "shared/utc_text.h"

namespace bess {

struct SiteClock {
  std::int64_t start_utc_s = 0;
  std::int32_t time_scale = 1;           ///< simulated seconds per second
  std::int64_t anchor_monotonic_ns = 0;  ///< CLOCK_MONOTONIC at the start

  /// For bess-sim.
  [[nodiscard]] std::vector<std::string> options() const {
    return {"--utc-start",           std::string(utc_text(start_utc_s).view()),
            "--time-scale",          std::to_string(time_scale),
            "--anchor-monotonic-ns", std::to_string(anchor_monotonic_ns)};
  }
  /// For bess-edge.
  [[nodiscard]] std::string table() const {
    return fmt::format(
        "[simulation]\ntime_scale = {}\nutc_start = \"{}\"\nanchor_monotonic_ns = {}\n", time_scale,
        utc_text(start_utc_s).view(), anchor_monotonic_ns);
  }
};

}  // namespace bess
