#include "tools/simulators/sim/clock_options.h"

#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {

void ClockOptions::add_to(ProgramCommand& app) {
  app.option("--utc-start", utc_start,
             "UTC at the anchor, e.g. 2023-03-26T00:00:00Z (default: real time)");
  app.option("--time-scale", time_scale, "simulated seconds per second (900: a day in 96 s)")
      .range(1, 100'000)
      .needs("--utc-start");
  app.option("--anchor-monotonic-ns", anchor_monotonic_ns,
             "CLOCK_MONOTONIC at --utc-start, ns (default: now); the same for all processes, from: "
             "bess-sim clock")
      .non_negative()
      .needs("--utc-start");
}

ScaledClock ClockOptions::clock() const {
  if (utc_start.empty()) return {};
  ScaledClock clock{.scale = time_scale};
  if (!parse_utc(utc_start, clock.anchor_utc_s)) {
    fail("--utc-start {}: is not a UTC time such as 2023-03-26T00:00:00Z", utc_start);
  }
  clock.anchor_monotonic_ns =
      anchor_monotonic_ns != 0 ? anchor_monotonic_ns : clock_ns(CLOCK_MONOTONIC);
  return clock;
}

}  // namespace bess
