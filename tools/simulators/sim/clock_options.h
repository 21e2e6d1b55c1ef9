// Options that set several processes to the same simulated clock (shared/scaled_clock.h).
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
  /// Real time without any of them. Throws UserError when they are inconsistent.
  [[nodiscard]] ScaledClock clock() const;
};

}  // namespace bess
