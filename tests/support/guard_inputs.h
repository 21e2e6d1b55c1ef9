// What the guard is asked when all is well: tests spoil one thing of it at a time.
#pragma once

#include "edge/control/safety_guard.h"

namespace bess {

inline constexpr std::int64_t kGuardNowS = 1'679'875'320;  ///< minute 2 of a quarter-hour
static_assert(kGuardNowS % 900 == 120);

inline GuardInputs healthy_inputs(Action action = Action::kCharge) {
  GuardInputs in;
  in.now_utc_s = kGuardNowS;
  in.clock_ok = in.link_ok = in.has_price = true;
  in.measurement.soc_e4 = 5'000;
  in.price_minute_utc_s = kGuardNowS - 60;
  in.price_centi_eur_per_mwh = 5'000;
  in.student_action = action;
  return in;
}

}  // namespace bess
