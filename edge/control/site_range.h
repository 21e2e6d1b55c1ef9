// How far an order may go, by the site: the result of meter and outside limits, the guard's input.
// Always contains 0 W: a limit takes power away and never asks for any; what asks is `relief_w`.
#pragma once

#include <cstdint>

#include "edge/control/control_types.h"

namespace bess {

struct SiteRange {
  std::int32_t charge_w_max = kAnyPowerW;     ///< 0 or more
  std::int32_t discharge_w_max = kAnyPowerW;  ///< 0 or more
  Reason charge_reason = Reason::kStudent;    ///< what set the limit
  Reason discharge_reason = Reason::kStudent;
  /// To be discharged at least, so that the quarter-hour stays under its cap; within SoC, cycle and
  /// power limits, and within `discharge_w_max`.
  std::int32_t relief_w = 0;

  /// The tightest limit names the reason; of equal ones the first.
  constexpr void limit_charge(std::int64_t power_w, Reason reason) {
    limit(power_w, reason, charge_w_max, charge_reason);
  }
  constexpr void limit_discharge(std::int64_t power_w, Reason reason) {
    limit(power_w, reason, discharge_w_max, discharge_reason);
  }
  constexpr void forbid(Reason reason) {
    limit_charge(0, reason);
    limit_discharge(0, reason);
  }

 private:
  static constexpr void limit(std::int64_t power_w, Reason reason, std::int32_t& power_w_max,
                              Reason& because) {
    if (power_w < 0) power_w = 0;
    if (power_w >= power_w_max) return;
    power_w_max = static_cast<std::int32_t>(power_w);
    because = reason;
  }
};

}  // namespace bess
