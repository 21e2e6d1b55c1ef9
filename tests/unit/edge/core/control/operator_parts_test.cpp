// Operator requests: holds, a reserve by the hour, full charges. Each separately,
// then in the guard.
#include <gtest/gtest.h>

#include "edge/core/control/full_charge.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/outlook.h"
#include "edge/core/control/reserve.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/loop/cycle_parts.h"
#include "tests/support/guard_inputs.h"

namespace bess {
namespace {

constexpr std::uint32_t kSoon = kNow + 600;

TEST(Hold, CrossesTheMailboxAsItIs) {
  LatestHold latest_hold;
  EXPECT_EQ(latest_hold.latest(), Hold{});
  for (const Hold& hold :
       {Hold{.power_w = -2'000, .until_utc_s = kSoon},
        Hold{.power_w = INT32_MAX, .until_utc_s = UINT32_MAX - 1},
        Hold{.power_w = INT32_MIN, .until_utc_s = 1}, Hold{.unreadable = true}, Hold{}}) {
    latest_hold.publish(hold);
    EXPECT_EQ(latest_hold.latest(), hold);
  }
}

TEST(FullCharge, IsSeenAtTheEndOfAStepAndNotBetweenTwoTicks) {
  FullChargePart part(7);
  CycleRecord record{.utc_s = kNow, .days_since_full = 3};
  part.restore(record);
  Reading reading{.purpose = ReadingPurpose::kCheck, .utc_s = kNow, .is_read = true};
  reading.response.measurement.soc_e4 = 10'000;
  part.observe(reading);
  part.report(record);
  EXPECT_EQ(record.days_since_full, 0) << "nothing was counted yet";
  reading.response.measurement.soc_e4 = 5'000;
  reading.purpose = ReadingPurpose::kTick;
  part.observe(reading);
  part.report(record);
  EXPECT_EQ(record.days_since_full, 3);
}

TEST(Hold, IsTakenUpAtATickAndNotBetweenTwo) {
  LatestHold latest_hold;
  HoldPart part;
  part.latest_hold = &latest_hold;
  CycleRecord record{.utc_s = kNow};
  GuardInputs in;
  latest_hold.publish({.power_w = 1'500, .until_utc_s = kSoon});
  part.put({.is_tick = false}, record, in);
  EXPECT_FALSE(in.held) << "the order in force is held against limits, not changed";
  part.put({.is_tick = true}, record, in);
  EXPECT_TRUE(in.held);
  EXPECT_EQ(in.held_power_w, 1'500);
}

TEST(Hold, HoldsUntilItsEndAndNotLongerThanAllowed) {
  const Hold hold{.power_w = -2'000, .until_utc_s = kSoon};
  EXPECT_TRUE(hold_at(hold, kNow).held);
  EXPECT_EQ(hold_at(hold, kNow).power_w, -2'000);
  EXPECT_EQ(hold_at(hold, kNow).until_utc_s, kSoon);
  EXPECT_TRUE(hold_at(hold, kSoon - 1).held);
  EXPECT_FALSE(hold_at(hold, kSoon).held);
  EXPECT_FALSE(hold_at(Hold{}, kNow).held);
  EXPECT_TRUE(hold_at(hold, kSoon - kHoldSecondsMax).held);
  EXPECT_TRUE(hold_at(hold, kSoon - kHoldSecondsMax - kHoldSecondsMin).held);
  const HoldReport of_a_wrong_clock = hold_at(hold, kSoon - kHoldSecondsMax - 121);
  EXPECT_FALSE(of_a_wrong_clock.held);
  EXPECT_TRUE(of_a_wrong_clock.unreadable);
  EXPECT_TRUE(hold_at({.unreadable = true}, kNow).unreadable);
}

LocalMinute at(int hour, int minute, int month = 6) {
  const int minute_of_day = hour * 60 + minute;
  return {.year = 2023,
          .month = month,
          .day = 1,
          .minute_of_day = minute_of_day,
          .quarter_hour = minute_of_day / 15,
          .minute_of_quarter_hour = minute_of_day % 15};
}

TEST(Reserve, TheHighestPeriodOfTheHourHolds) {
  ReservePlan plan;
  EXPECT_EQ(reserve_soc_e4_at(plan, at(12, 0)), 0);
  plan.push_back({.from_minute = 17 * 60, .to_minute = 20 * 60, .soc_e4 = 3'000});
  EXPECT_EQ(reserve_soc_e4_at(plan, at(16, 59)), 0);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(17, 0)), 3'000);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(19, 59)), 3'000);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(20, 0)), 0);
  plan.push_back({.soc_e4 = 1'500});  // the whole day
  EXPECT_EQ(reserve_soc_e4_at(plan, at(0, 0)), 1'500);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(18, 0)), 3'000);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(23, 59)), 1'500);
}

TEST(Reserve, WrapsOverMidnightAndKnowsMonths) {
  ReservePlan plan;
  plan.push_back({.from_minute = 22 * 60,
                  .to_minute = 6 * 60,
                  .soc_e4 = 4'000,
                  .months = 1 << 0 | 1 << 11});  // January, December
  EXPECT_EQ(reserve_soc_e4_at(plan, at(23, 0, 12)), 4'000);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(5, 59, 1)), 4'000);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(6, 0, 1)), 0);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(23, 0, 11)), 0);
  EXPECT_EQ(reserve_soc_e4_at(plan, at(3, 0, 2)), 0);
}

TEST(FullCharge, IsDueAfterTheDaysAndUrgentADayLater) {
  FullCharge charge(10);
  const PriceLevel level = PriceLevel::starting_at(8'000);
  charge.update(100, 5'000);  // nothing known: the days count from now on
  EXPECT_EQ(charge.days_since_full(), 0);
  charge.update(109, 9'949);
  EXPECT_EQ(charge.request(-50'000, level), FullChargeRequest::kNone);
  charge.update(110, 5'000);
  EXPECT_EQ(charge.days_since_full(), 10);
  EXPECT_EQ(charge.request(8'001, level), FullChargeRequest::kNoDischarge);
  EXPECT_EQ(charge.request(8'000, level), FullChargeRequest::kCharge);
  EXPECT_EQ(charge.request(8'001, PriceLevel{}),
            FullChargeRequest::kCharge);  // no level to wait for
  charge.update(111, 5'000);
  EXPECT_EQ(charge.request(100'000, level), FullChargeRequest::kCharge);
  charge.update(111, 9'950);
  EXPECT_EQ(charge.days_since_full(), 0);
  EXPECT_EQ(charge.request(-50'000, level), FullChargeRequest::kNone);
}

TEST(FullCharge, OffNeverWantsAnything) {
  FullCharge charge(0);
  charge.restore(1);
  charge.update(20'000, 5'000);
  EXPECT_EQ(charge.days_since_full(), 19'999);
  EXPECT_EQ(charge.request(-50'000, {}), FullChargeRequest::kNone);
}

TEST(FullCharge, ARestartContinuesTheCount) {
  set_market_time_zone();
  const std::int32_t today = local_day_number(local_minute_of(kNow));
  EXPECT_EQ(last_full_day_of(kNow, 6), today - 6);
  EXPECT_EQ(last_full_day_of(0, 0), 0);  // no record
  FullCharge charge(10);
  charge.restore(last_full_day_of(kNow, 6));
  charge.update(today + 4, 5'000);
  EXPECT_EQ(charge.days_since_full(), 10);
  charge.restore(today + 99);  // logged while the clock was wrong
  charge.update(today, 5'000);
  EXPECT_EQ(charge.days_since_full(), 0);
}

constexpr GuardSettings kSettings{};

GuardDecision decide(const GuardInputs& in, const GuardSettings& settings = kSettings) {
  return SafetyGuard(settings).decide(in);
}

TEST(GuardOfHolds, ReplacesTheStudentTheThresholdsAndTheNeedOfAPrice) {
  GuardInputs in = healthy();
  in.held = true;
  in.held_power_w = -1'500;
  expect(decide(in), -1'500, Reason::kHeld);
  in.price_centi_eur_per_mwh = -60'000;
  expect(decide(in), -1'500, Reason::kHeld);
  in.full_charge = FullChargeRequest::kCharge;
  expect(decide(in), -1'500, Reason::kHeld);
  in.has_price = false;
  expect(decide(in), -1'500, Reason::kHeld);
  in.has_price = true;
  in.price_minute_utc_s = kNow - 86'400;
  expect(decide(in), -1'500, Reason::kHeld);
  in.held_power_w = -9'000;  // allowed under another power_w
  expect(decide(in), -4'000, Reason::kHeld);
}

TEST(GuardOfHolds, IsWeakerThanEveryStopReasonAndLimit) {
  GuardInputs in = healthy();
  in.held = true;
  in.held_power_w = -3'000;
  in.has_price = false;
  const auto with = [&](auto spoil) {
    GuardInputs spoilt = in;
    spoil(spoilt);
    return spoilt;
  };
  expect(decide(with([](GuardInputs& i) { i.clock_ok = false; })), 0, Reason::kClock);
  expect(decide(with([](GuardInputs& i) { i.link_ok = false; })), 0, Reason::kLink);
  expect(decide(with([](GuardInputs& i) { i.measurement.alarm = true; })), 0, Reason::kAlarm);
  expect(decide(with([](GuardInputs& i) { i.measurement.off_grid = true; })), 0, Reason::kOffGrid);
  expect(decide(with([](GuardInputs& i) { i.supervision = Reason::kWrongDirection; })), 0,
         Reason::kWrongDirection);
  expect(decide(with([](GuardInputs& i) { i.measurement.temperature_max_deci_c = 600; })), 0,
         Reason::kTemperature);
  expect(decide(with([](GuardInputs& i) { i.measurement.soc_e4 = 1'000; })), 0, Reason::kSocEmpty);
  expect(decide(with([](GuardInputs& i) { i.reserve_soc_e4 = 5'000; })), 0, Reason::kReserve);
  expect(decide(with([](GuardInputs& i) { i.cycle_budget_spent = true; })), 0,
         Reason::kCycleBudget);
  expect(decide(with([](GuardInputs& i) { i.measurement.discharge_w_max = 700; })), -700,
         Reason::kPowerLimit);
  GuardSettings ramped = kSettings;
  ramped.ramp_w_max = 1'000;
  expect(decide(in, ramped), -1'000, Reason::kRamp);
}

TEST(GuardOfTheReserve, ClosesDischargingBelowItAndOpensAboveItsHysteresis) {
  SafetyGuard guard(kSettings);
  GuardInputs in = healthy(Action::kDischarge);
  in.reserve_soc_e4 = 3'000;
  expect(guard.decide(in), -4'000, Reason::kStudent);
  in.measurement.soc_e4 = 3'000;
  expect(guard.decide(in), 0, Reason::kReserve);
  in.measurement.soc_e4 = 3'050;
  expect(guard.decide(in), 0, Reason::kReserve);
  in.measurement.soc_e4 = 3'051;
  expect(guard.decide(in), -4'000, Reason::kStudent);
  in.reserve_soc_e4 = 4'000;  // the next hour's
  expect(guard.decide(in), 0, Reason::kReserve);
  in.price_centi_eur_per_mwh = 200'000;
  in.student_action = Action::kIdle;
  expect(guard.decide(in), 0, Reason::kReserve);  // thresholds too
  in.student_action = Action::kCharge;
  in.price_centi_eur_per_mwh = 5'000;
  expect(guard.decide(in), 4'000, Reason::kStudent);  // charging is free
  in.student_action = Action::kDischarge;
  in.reserve_soc_e4 = 0;
  expect(guard.decide(in), -4'000, Reason::kStudent);
}

TEST(GuardOfTheReserve, SaysEmptyBelowSocMin) {
  GuardInputs in = healthy(Action::kDischarge);
  in.reserve_soc_e4 = 3'000;
  in.measurement.soc_e4 = 900;
  expect(decide(in), 0, Reason::kSocEmpty);
}

TEST(GuardOfFullCharges, ReplacesTheStudentBetweenTheThresholds) {
  GuardInputs in = healthy(Action::kDischarge);
  in.full_charge = FullChargeRequest::kNoDischarge;
  expect(decide(in), 0, Reason::kFullCharge);
  in.student_action = Action::kCharge;
  expect(decide(in), 4'000, Reason::kStudent);
  in.student_action = Action::kIdle;
  expect(decide(in), 0, Reason::kStudent);
  in.full_charge = FullChargeRequest::kCharge;
  expect(decide(in), 2'000, Reason::kFullCharge);
  in.price_centi_eur_per_mwh = 150'000;
  expect(decide(in), -4'000, Reason::kPriceHigh);
  in.price_centi_eur_per_mwh = -50'000;
  expect(decide(in), 4'000, Reason::kPriceLow);
  in.price_centi_eur_per_mwh = 5'000;
  in.measurement.soc_e4 = 10'000;
  expect(decide(in), 0, Reason::kSocFull);
}

}  // namespace
}  // namespace bess
