// Consequences of findings: trips stay, pauses end and grow, conditions pass.
#include "edge/core/supervision/supervision.h"

#include <gtest/gtest.h>

#include "tests/support/driven_reading.h"

namespace bess {
namespace {

const SupervisionSettings kSettings{
    .response = {}, .capacity_wh_min = 6'000, .capacity_wh_max = 10'000};

Response reading(std::int64_t utc_s, std::int32_t ordered_w, std::int32_t measured_w) {
  Response now = driven_reading(utc_s, ordered_w, measured_w);
  now.measurement.dispatch_active = true;
  return now;
}

/// In its own mode, without an order.
Response resting(std::int64_t utc_s, std::int32_t measured_w = 0) {
  Response now = driven_reading(utc_s, 0, measured_w);
  now.is_driven = false;
  return now;
}

Response replaced(std::int64_t utc_s) {
  Response now = reading(utc_s, 4'000, -4'500);
  now.is_driven = false;
  now.order_number = utc_s;
  now.measurement.order_replaced = true;
  return now;
}

TEST(Supervision, ATripStaysUntilItIsCleared) {
  Supervision supervision(kSettings);
  for (int i = 1; i <= 2; ++i) supervision.observe(reading(120 * i, 4'000, -4'000), false);
  EXPECT_EQ(supervision.stop_reason(), Reason::kWrongDirection);
  EXPECT_EQ(supervision.trip()->utc_s, 240);
  for (int i = 3; i <= 800; ++i) supervision.observe(reading(120 * i, 0, 0), false);
  EXPECT_EQ(supervision.stop_reason(), Reason::kWrongDirection);
  EXPECT_EQ(supervision.trip()->utc_s, 240);
  supervision.clear();
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
}

TEST(Supervision, ATripOfAnEarlierRunHoldsFromTheStart) {
  Supervision supervision(kSettings);
  supervision.restore(Trip{.reason = Reason::kUncontrolledPower, .utc_s = 7});
  EXPECT_EQ(supervision.stop_reason(), Reason::kUncontrolledPower);
}

TEST(Supervision, NoAnswerPausesLongerEachTime) {
  Supervision supervision(kSettings);
  std::int64_t utc_s = 0;
  for (std::int64_t pause_s = Pause::kFirstS; pause_s < Pause::kLongestS; pause_s *= 2) {
    for (int i = 0; i < 2; ++i) supervision.observe(reading(utc_s += 120, 4'000, 0), false);
    ASSERT_EQ(supervision.stop_reason(), Reason::kNoAnswer);
    supervision.observe(resting(utc_s + pause_s - 1), true);
    EXPECT_EQ(supervision.stop_reason(), Reason::kNoAnswer);
    supervision.observe(resting(utc_s += pause_s), true);
    EXPECT_EQ(supervision.stop_reason(), std::nullopt);
  }
}

TEST(Supervision, AGoodAnswerMakesTheNextPauseShortAgain) {
  Supervision supervision(kSettings);
  std::int64_t utc_s = 0;
  const auto unanswered_twice = [&] {
    for (int i = 0; i < 2; ++i) supervision.observe(reading(utc_s += 120, 4'000, 0), false);
  };
  unanswered_twice();
  supervision.observe(reading(utc_s += Pause::kFirstS, 4'000, 4'000), false);
  unanswered_twice();
  ASSERT_EQ(supervision.stop_reason(), Reason::kNoAnswer);
  supervision.observe(resting(utc_s += Pause::kFirstS), true);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
}

TEST(Supervision, OrdersThatFailRepeatedlyAreAbandoned) {
  Supervision supervision(kSettings);
  supervision.on_ordered(0, Status::kBadReply);
  supervision.on_ordered(120, Status::kBadReply);
  supervision.on_ordered(240, Status::kOk);
  for (int i = 3; i < 6; ++i) {
    EXPECT_EQ(supervision.stop_reason(), std::nullopt);
    supervision.on_ordered(120 * i, Status::kBadReply);
  }
  EXPECT_EQ(supervision.stop_reason(), Reason::kOrdersFail);
}

TEST(Supervision, ASpentFlashBudgetIsNoFault) {
  Supervision supervision(kSettings);
  for (int i = 0; i < 20; ++i) supervision.on_ordered(120 * i, Status::kWriteBudget);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
}

TEST(Supervision, YieldsToAnotherMasterForAsLongAsItOrders) {
  Supervision supervision(kSettings);
  supervision.observe(replaced(120), false);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
  supervision.observe(replaced(240), false);
  EXPECT_EQ(supervision.stop_reason(), Reason::kOtherMaster);
  EXPECT_EQ(supervision.lost_orders().replaced(), 2);
  std::int64_t utc_s = 240;
  Response foreign = reading(utc_s, -4'500, -4'500);
  foreign.is_driven = false;
  for (int i = 0; i < 30; ++i) {
    foreign.utc_s = foreign.steady_s = utc_s += 120;
    supervision.observe(foreign, true);
    ASSERT_EQ(supervision.stop_reason(), Reason::kOtherMaster);
  }
  foreign.measurement.dispatch_active = false;
  foreign.utc_s = foreign.steady_s = utc_s += Pause::kFirstS;
  supervision.observe(foreign, true);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
}

TEST(Supervision, InsistsOnItsOrdersWhenConfigured) {
  SupervisionSettings settings = kSettings;
  settings.yields_to_other_master = false;
  Supervision supervision(settings);
  for (int i = 1; i <= 10; ++i) supervision.observe(replaced(120 * i), false);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
  EXPECT_EQ(supervision.lost_orders().replaced(), 10);
}

TEST(Supervision, AnotherCapacityStopsForAsLongAsItIsRead) {
  Supervision supervision(kSettings);
  Response now = reading(120, 0, 0);
  now.measurement.capacity_wh = 100'000;
  supervision.observe(now, false);
  EXPECT_EQ(supervision.stop_reason(), Reason::kCapacity);
  now.utc_s = now.steady_s = 240;
  now.measurement.capacity_wh = 8'000;
  supervision.observe(now, false);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
  now.measurement.capacity_wh = 0;  // a device that reports none
  supervision.observe(now, false);
  EXPECT_EQ(supervision.stop_reason(), std::nullopt);
}

/// Ten minutes each time, and a trip only after a day without a good reading.
TEST(Supervision, ABatteryThatRecoversByItselfIsLeftAloneForAWhile) {
  Supervision supervision(kSettings);
  const auto balancing = [](std::int64_t utc_s) {
    Response now = reading(utc_s, 0, 450);
    now.measurement.soc_e4 = 9'900;
    return now;
  };
  std::int64_t utc_s = 0;
  int pauses = 0;
  while (utc_s < 23 * 3'600) {
    supervision.observe(balancing(utc_s += 120), false);
    ASSERT_FALSE(supervision.trip()) << utc_s;
    if (supervision.stop_reason() != Reason::kBatteryCare) continue;
    ++pauses;
    Response own = balancing(utc_s += Pause::kFirstS);
    own.is_driven = own.measurement.dispatch_active = false;
    supervision.observe(own, true);
    ASSERT_EQ(supervision.stop_reason(), std::nullopt);
  }
  EXPECT_GT(pauses, 90);
  Supervision forgiven = supervision;
  while (utc_s < 25 * 3'600) supervision.observe(balancing(utc_s += 120), false);
  EXPECT_EQ(supervision.trip()->reason, Reason::kUncontrolledPower);
  forgiven.observe(reading(utc_s += 120, 0, 0), false);
  for (int i = 0; i < 60; ++i) forgiven.observe(balancing(utc_s += 120), false);
  EXPECT_FALSE(forgiven.trip());
}

}  // namespace
}  // namespace bess
