// Options that set several processes to the same simulated clock (shared/scaled_clock.h).
#pragma once

#include <cstdint>
#include <string>

#include "shared/host/command_line.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {

struct ClockOptions {
  std::string utc_start;
  std::int32_t time_scale = 1;
  std::int64_t anchor_monotonic_ns = 0;

  /// Declares --utc-start, --time-scale and --anchor-monotonic-ns.
  void add_to(ProgramCommand& app) {
    app.option("--utc-start", utc_start,
               "UTC at the anchor, e.g. 2023-03-26T00:00:00Z (default: real time)");
    app.option("--time-scale", time_scale, "simulated seconds per second (900: a day in 96 s)")
        .range(1, 100'000)
        .needs("--utc-start");
    app.option(
           "--anchor-monotonic-ns", anchor_monotonic_ns,
           "CLOCK_MONOTONIC at --utc-start, ns (default: now); the same for all processes, from: "
           "bess-sim clock")
        .non_negative()
        .needs("--utc-start");
  }
  /// Real time without any of them. Throws UserError when they are inconsistent.
  [[nodiscard]] ScaledClock clock() const {
    if (utc_start.empty()) return {};
    ScaledClock clock{.scale = time_scale};
    if (!parse_utc(utc_start, clock.anchor_utc_s)) {
      fail("--utc-start {}: is not a UTC time such as 2023-03-26T00:00:00Z", utc_start);
    }
    clock.anchor_monotonic_ns =
        anchor_monotonic_ns != 0 ? anchor_monotonic_ns : clock_ns(CLOCK_MONOTONIC);
    return clock;
  }
};

}  // namespace bess
