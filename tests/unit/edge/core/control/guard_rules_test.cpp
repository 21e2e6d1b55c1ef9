// Rules of the operator in the guard: above student and thresholds, below holds, limits and stop
// reasons.
#include <gtest/gtest.h>

#include "edge/core/control/policy.h"
#include "edge/core/control/safety_guard.h"
#include "tests/support/guard_inputs.h"

namespace bess {
namespace {

constexpr ActionSet kNoCharge = action_bit(Action::kDischarge) | action_bit(Action::kIdle);
constexpr ActionSet kNoDischarge = action_bit(Action::kCharge) | action_bit(Action::kIdle);

GuardInputs ruled(Action action, const RuleLimits& rules) {
  GuardInputs in = healthy(action);
  in.rules = rules;
  return in;
}

void expect(const GuardInputs& in, std::int32_t power_w, Reason reason,
            const GuardSettings& settings = {}) {
  const GuardDecision decision = SafetyGuard(settings).decide(in);
  EXPECT_EQ(decision.power_w, power_w);
  EXPECT_EQ(decision.reason, reason) << reason_name(decision.reason);
}

TEST(GuardRules, MoveTheStudentToTheNearestActionThatIsAllowed) {
  expect(ruled(Action::kCharge, {kNoCharge, 1000}), 0, Reason::kRule);
  expect(ruled(Action::kDischarge, {kNoDischarge, 1000}), 0, Reason::kRule);
  expect(ruled(Action::kIdle, {action_bit(Action::kCharge), 1000}), 4'000, Reason::kRule);
  expect(ruled(Action::kCharge, {action_bit(Action::kDischarge), 1000}), -4'000, Reason::kRule);
}

TEST(GuardRules, AnObedientStudentIsNoIntervention) {
  expect(ruled(Action::kDischarge, {kNoCharge, 1000}), -4'000, Reason::kStudent);
  expect(ruled(Action::kIdle, {kNoCharge, 500}), 0, Reason::kStudent);
}

TEST(GuardRules, CapThePowerBothWays) {
  expect(ruled(Action::kCharge, {kAllActions, 500}), 2'000, Reason::kRule);
  expect(ruled(Action::kDischarge, {kAllActions, 250}), -1'000, Reason::kRule);
  expect(ruled(Action::kDischarge, {kAllActions, 0}), 0, Reason::kRule);
  expect(ruled(Action::kCharge, {action_bit(Action::kDischarge), 500}), -2'000, Reason::kRule);
  expect(ruled(Action::kCharge, {kAllActions, 500}), 1'000'000'000, Reason::kRule,
         {.power_w = 2'000'000'000});
}

TEST(GuardRules, OverrideThresholdsAndFullCharges) {
  GuardInputs in = ruled(Action::kIdle, {kNoCharge, 1000});
  in.price_centi_eur_per_mwh = -50'000;
  expect(in, 0, Reason::kRule);
  in.price_centi_eur_per_mwh = 5'000;
  in.full_charge = FullChargeRequest::kCharge;
  expect(in, 0, Reason::kRule);
}

TEST(GuardRules, YieldToHoldsLimitsAndStopReasons) {
  GuardInputs in = ruled(Action::kIdle, {action_bit(Action::kDischarge), 1000});
  expect(in, -4'000, Reason::kRule);
  in.reserve_soc_e4 = 6'000;
  expect(in, 0, Reason::kReserve);
  in.reserve_soc_e4 = 0;
  in.measurement.soc_e4 = 1'000;
  expect(in, 0, Reason::kSocEmpty);
  in.measurement.soc_e4 = 5'000;
  expect(in, -1'500, Reason::kRamp, {.ramp_w_max = 1'500});
  in.held = true;
  in.held_power_w = 700;
  expect(in, 700, Reason::kHeld);
  in.held = false;
  in.measurement.alarm = true;
  expect(in, 0, Reason::kAlarm);
}

}  // namespace
}  // namespace bess
