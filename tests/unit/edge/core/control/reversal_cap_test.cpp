// Reversals between charging and discharging, counted over the last hour.
#include "edge/core/control/cycle_budget.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kStart = 1'679'875'200;

/// Orders one power per step and returns the reversals of the hour.
class Orders {
 public:
  explicit Orders(std::int32_t per_hour_max) : cap(per_hour_max) { cap.advance(now_utc_s); }
  int order(std::int32_t power_w) {
    now_utc_s += kSecondsPerStep;
    cap.advance(now_utc_s);
    cap.note(power_w);
    return cap.history().in_hour;
  }

  ReversalCap cap;
  std::int64_t now_utc_s = kStart;
};

TEST(ReversalCap, CountsChangesOfTheSignWhateverIdlesBetween) {
  Orders orders(20);
  EXPECT_EQ(orders.order(4'000), 0);
  EXPECT_EQ(orders.order(500), 0);
  EXPECT_EQ(orders.order(-4'000), 1);
  EXPECT_EQ(orders.order(0), 1);
  EXPECT_EQ(orders.order(-4'000), 1) << "the same direction again";
  EXPECT_EQ(orders.order(0), 1);
  EXPECT_EQ(orders.order(1), 2);
}

TEST(ReversalCap, AtTheCapTheOtherDirectionIsBarredUntilTheHourHasMovedOn) {
  Orders orders(2);
  orders.order(4'000);
  orders.order(-4'000);
  EXPECT_EQ(orders.cap.barred_direction(), 0);
  orders.order(4'000);
  EXPECT_EQ(orders.cap.barred_direction(), -1);
  int steps_barred = 0;
  while (orders.cap.barred_direction() != 0) {
    orders.order(steps_barred % 2 == 0 ? 0 : 4'000);  // what is not barred frees nothing
    ++steps_barred;
  }
  EXPECT_EQ(steps_barred, kStepsPerHour - 1);  // the older of the two is an hour old
  EXPECT_EQ(orders.cap.history().in_hour, 1);
}

TEST(ReversalCap, WithoutACapNothingIsBarred) {
  Orders orders(0);
  for (int i = 0; i < 100; ++i) orders.order(i % 2 == 0 ? 4'000 : -4'000);
  EXPECT_EQ(orders.cap.history().in_hour, kStepsPerHour);
  EXPECT_EQ(orders.cap.barred_direction(), 0);
}

/// A restart must not allow a wrong source another hour's reversals.
TEST(ReversalCap, ARestartContinuesTheCount) {
  Orders before(3);
  for (const std::int32_t power_w : {1, -1, 1, -1}) before.order(power_w);
  ReversalCap after(3);
  after.restore(before.cap.history(), before.now_utc_s);
  after.advance(before.now_utc_s + 10 * kSecondsPerStep);
  EXPECT_EQ(after.history().in_hour, 3);
  EXPECT_EQ(after.barred_direction(), 1);
  after.advance(before.now_utc_s + kStepsPerHour * kSecondsPerStep);
  EXPECT_EQ(after.history().in_hour, 0);
}

TEST(ReversalCap, AClockThatIsSteppedBackForgetsNothing) {
  Orders orders(1);
  orders.order(1);
  orders.order(-1);
  orders.cap.advance(kStart - 86'400);
  EXPECT_EQ(orders.cap.barred_direction(), 1);
  orders.cap.advance(kStart - 86'400 + kStepsPerHour * kSecondsPerStep);
  EXPECT_EQ(orders.cap.barred_direction(), 0);
}

}  // namespace
}  // namespace bess
