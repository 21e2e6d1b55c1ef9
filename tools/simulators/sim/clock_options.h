// The options that put several processes on the same simulated clock (shared/scaled_clock.h).
#pragma once

#include <cstdint>
#include <string>

#include "shared/host/command_line.h"
#include "shared/scaled_clock.h"

namespace bess {

struct ClockOptions {
  std::string utc_start;
  std::int32_t time_scale = 1;
  std::int64_t anchor_monotonic_ns = 0;

  /// Declares --utc-start, --time-scale and --anchor-monotonic-ns.
  void add_to(ProgramCommand& app);
  /// Throws UserError when they do not make sense. Without any of them: real time.
  [[nodiscard]] ScaledClock clock() const;
};

}  // namespace bess
