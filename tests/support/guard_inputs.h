// Guard inputs of a healthy state.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "edge/core/control/safety_guard.h"

namespace bess {

inline constexpr std::int64_t kNow = 1'679'875'320;  // 2023-03-27T00:02:00Z, 02:02 in Brussels
static_assert(kNow % 900 == 120, "minute 2 of a quarter-hour");

inline GuardInputs healthy(Action action = Action::kCharge) {
  GuardInputs in;
  in.now_utc_s = kNow;
  in.clock_ok = in.link_ok = in.has_price = true;
  in.measurement.soc_e4 = 5'000;
  in.price_minute_utc_s = kNow - 60;
  in.price_centi_eur_per_mwh = 5'000;
  in.student_action = action;
  return in;
}

inline void expect(const GuardDecision& decision, std::int32_t power_w, Reason reason) {
  EXPECT_EQ(decision.power_w, power_w);
  EXPECT_EQ(reason_name(decision.reason), reason_name(reason));
}

}  // namespace bess
