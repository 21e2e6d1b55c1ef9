// Lost orders: which count, detection time, unintended losses, and how long control insists.
#include "edge/core/supervision/lost_orders.h"

#include <gtest/gtest.h>

#include <functional>

#include "edge/core/supervision/supervision.h"

namespace bess {
namespace {

constexpr std::int64_t kFirstUtcS = 1'679'788'800;
constexpr std::int32_t kW = 3'000;

enum class OrderOutcome { kHolds, kReplaced, kEnded };

Response reading(std::int64_t number, OrderOutcome outcome, std::int32_t ordered_w = kW) {
  const bool holds = outcome == OrderOutcome::kHolds;
  return {.utc_s = kFirstUtcS + kSecondsPerStep * number,
          .steady_s = kFirstUtcS + kSecondsPerStep * number,
          .is_driven = holds,
          .order_number = number,
          .ordered_power_w = ordered_w,
          .order_age_s = 115,
          .measurement = {.soc_e4 = 5'000,
                          .power_w = holds ? ordered_w : 0,
                          .dispatch_active = holds,
                          .order_replaced = outcome == OrderOutcome::kReplaced,
                          .order_ended = outcome == OrderOutcome::kEnded}};
}

/// Readings until the release of the battery; 0: not within `most`.
int given_back_after(const std::function<OrderOutcome(int)>& outcome, bool yields = true,
                     int most = 400) {
  LostOrders orders{ResponseSettings{}};
  for (int i = 1; i <= most; ++i) {
    const Response now = reading(i, outcome(i));
    orders.observe(now, false);
    if (orders.is_to_be_given_up(now.steady_s, yields)) return i;
  }
  return 0;
}

TEST(LostOrders, AnIntermittentControllerIsFoundAsWell) {
  for (const OrderOutcome lost : {OrderOutcome::kReplaced, OrderOutcome::kEnded}) {
    const auto every = [lost](int k) {
      return [lost, k](int i) { return i % k == 0 ? lost : OrderOutcome::kHolds; };
    };
    EXPECT_EQ(given_back_after(every(1)), 2);
    EXPECT_EQ(given_back_after(every(2)), 4);
    EXPECT_EQ(given_back_after(every(3)), 9);
    EXPECT_EQ(given_back_after(every(4)), 0);
    EXPECT_EQ(given_back_after([lost](int i) { return i == 7 ? lost : OrderOutcome::kHolds; }), 0);
  }
}

/// Alternating stop and other power: one master.
TEST(LostOrders, EndsAndReplacementsCountTogether) {
  const auto mixed = [](int i) {
    return i % 4 == 0   ? OrderOutcome::kEnded
           : i % 2 == 0 ? OrderOutcome::kReplaced
                        : OrderOutcome::kHolds;
  };
  EXPECT_EQ(given_back_after(mixed), 4);
}

TEST(LostOrders, TheReasonIsTheHandThatWasSeen) {
  for (const bool replaced : {false, true}) {
    LostOrders orders{ResponseSettings{}};
    orders.observe(reading(1, replaced ? OrderOutcome::kReplaced : OrderOutcome::kEnded), false);
    orders.observe(reading(2, OrderOutcome::kEnded), false);
    EXPECT_EQ(orders.reason(), replaced ? Reason::kOtherMaster : Reason::kNoAnswer);
    EXPECT_EQ(orders.replaced(), replaced ? 1 : 0);
    EXPECT_EQ(orders.ended(), replaced ? 1 : 2);
  }
}

/// After a reboot the device may repeatedly show the lost order, until it takes the next.
TEST(LostOrders, OneOrderIsLostOnce) {
  LostOrders orders{ResponseSettings{}};
  for (int i = 0; i < 5; ++i) {
    Response now = reading(1, OrderOutcome::kEnded);
    now.steady_s += 120 * i;
    orders.observe(now, false);
    EXPECT_FALSE(orders.is_to_be_given_up(now.steady_s, true));
  }
  EXPECT_EQ(orders.ended(), 1);
}

/// Read as ours before the tick, replaced before the refresh at the tick: the same number.
TEST(LostOrders, AnOrderThatWasSeenToHoldCanStillBeLost) {
  LostOrders orders{ResponseSettings{}};
  orders.observe(reading(1, OrderOutcome::kHolds), false);
  orders.observe(reading(1, OrderOutcome::kReplaced), false);
  EXPECT_EQ(orders.replaced(), 1);
}

TEST(LostOrders, UnintendedEndsAreNoFinding) {
  struct Case {
    const char* name;
    std::int32_t ordered_w;
    std::function<void(Response&)> is;
    bool is_lost;
  };
  const Case cases[] = {
      {"mid charge", kW, [](Response&) {}, true},
      {"0 W that rests", 0, [](Response&) {}, false},
      {"0 W that flows", 0, [](Response& r) { r.measurement.power_w = -900; }, true},
      {"full", kW, [](Response& r) { r.measurement.soc_e4 = 9'500; }, false},
      {"full while discharging", -kW, [](Response& r) { r.measurement.soc_e4 = 9'500; }, true},
      {"full by our own ceiling", kW,
       [](Response& r) {
         r.soc_ceiling_e4 = 8'000;
         r.measurement.soc_e4 = 7'500;
       },
       false},
      {"below that", kW, [](Response& r) { r.measurement.soc_e4 = 9'400; }, true},
      {"empty", -kW, [](Response& r) { r.measurement.soc_e4 = 2'000; }, false},
      {"empty while charging", kW, [](Response& r) { r.measurement.soc_e4 = 500; }, true},
      {"at the reserve", -kW,
       [](Response& r) {
         r.soc_floor_e4 = 6'000;
         r.measurement.soc_e4 = 6'100;
       },
       false},
      {"not full yet", kW, [](Response& r) { r.measurement.soc_e4 = 9'490; }, true},
      {"the device takes none", kW, [](Response& r) { r.measurement.charge_w_max = 0; }, false},
      {"the device gives none", -kW, [](Response& r) { r.measurement.discharge_w_max = 0; }, false},
      {"the other limit", kW, [](Response& r) { r.measurement.discharge_w_max = 0; }, true},
      {"cold", kW, [](Response& r) { r.measurement.temperature_min_deci_c = 79; }, false},
      {"cold while discharging", -kW,
       [](Response& r) { r.measurement.temperature_min_deci_c = 79; }, true},
      {"an alarm", kW, [](Response& r) { r.measurement.alarm = true; }, false},
      {"an island", kW, [](Response& r) { r.measurement.off_grid = true; }, false},
  };
  for (const Case& c : cases) {
    LostOrders orders{ResponseSettings{}};
    Response now = reading(1, OrderOutcome::kEnded, c.ordered_w);
    c.is(now);
    orders.observe(now, false);
    EXPECT_EQ(orders.ended(), c.is_lost ? 1 : 0) << c.name;
    now.measurement.order_ended = false;
    now.measurement.order_replaced = true;
    now.order_number = 2;
    const bool is_safety = now.measurement.alarm || now.measurement.off_grid;
    orders.observe(now, false);
    EXPECT_EQ(orders.replaced(), is_safety ? 0 : 1) << c.name << ": a register change counts";
  }
}

TEST(LostOrders, RestForgivesNothingButTwoHoursDo) {
  for (const auto& [hours, found] : {std::pair{1, true}, {3, false}}) {
    LostOrders orders{ResponseSettings{}};
    orders.observe(reading(1, OrderOutcome::kReplaced), false);
    const int next = 1 + 30 * hours;
    for (int i = 2; i < next; ++i) orders.observe(reading(i, OrderOutcome::kHolds, 0), false);
    orders.observe(reading(next, OrderOutcome::kReplaced), false);
    EXPECT_EQ(orders.is_to_be_given_up(kFirstUtcS + next * kSecondsPerStep, true), found) << hours;
  }
}

TEST(LostOrders, InsistsForAnHourAndAfterThatOnlyAgainstFew) {
  const auto every = [](int k) {
    return [k](int i) { return i % k == 0 ? OrderOutcome::kReplaced : OrderOutcome::kHolds; };
  };
  EXPECT_EQ(given_back_after(every(1), false), 31);
  EXPECT_EQ(given_back_after(every(2), false), 32);
  EXPECT_EQ(given_back_after(every(3), false), 0) << "two of three orders last: it continues";
}

TEST(LostOrders, TheNextTryEndsSoonerUntilOrdersHaveLasted) {
  LostOrders orders{ResponseSettings{}};
  int i = 0;
  const auto lose_until_given_up = [&] {
    for (int n = 1;; ++n) {
      const Response now = reading(++i, OrderOutcome::kReplaced);
      orders.observe(now, false);
      if (!orders.is_to_be_given_up(now.steady_s, false)) continue;
      orders.forget_findings();
      return n;
    }
  };
  EXPECT_EQ(lose_until_given_up(), 31);
  i += 5;  // the pause
  EXPECT_EQ(lose_until_given_up(), 2);
  for (int n = 0; n < 40; ++n) orders.observe(reading(++i, OrderOutcome::kHolds), false);
  EXPECT_TRUE(orders.has_settled());
  EXPECT_EQ(lose_until_given_up(), 31);
}

TEST(LostOrders, TheShareOfTheLastHourOutlastsARestart) {
  LostOrders orders{ResponseSettings{}};
  for (int i = 1; i <= 60; ++i)
    orders.observe(reading(i, i % 3 == 0 ? OrderOutcome::kEnded : OrderOutcome::kHolds), false);
  EXPECT_EQ(orders.history().judged, 30);
  EXPECT_EQ(orders.history().lost, 10);
  LostOrders next{ResponseSettings{}};
  next.restore(orders.history(), kFirstUtcS + 60 * kSecondsPerStep);
  EXPECT_EQ(next.history(), orders.history());
  EXPECT_EQ(next.ended(), 0) << "since start";
  next.observe(reading(63, OrderOutcome::kEnded), false);
  EXPECT_TRUE(next.is_to_be_given_up(kFirstUtcS + 63 * kSecondsPerStep, true));
}

/// A run that is killed after each loss: the level continues.
TEST(LostOrders, ManyShortRunsFindItTogether) {
  LostOrderHistory logged;
  int found = 0;
  for (int run = 1; run <= 3 && found == 0; ++run) {
    LostOrders orders{ResponseSettings{}};
    const std::int64_t utc_s = kFirstUtcS + run * 165;
    orders.restore(logged, utc_s - 60);
    Response now = reading(1, OrderOutcome::kReplaced);
    now.steady_s = utc_s;
    orders.observe(now, false);
    if (orders.is_to_be_given_up(utc_s, true)) found = run;
    logged = orders.history();
  }
  EXPECT_EQ(found, 2);
}

TEST(LostOrders, ADamagedHistoryIsBounded) {
  LostOrders orders{ResponseSettings{}};
  orders.restore({.orders = UINT32_MAX, .judged = INT16_MAX, .lost = INT16_MIN}, kFirstUtcS);
  EXPECT_EQ(orders.history().judged, 30);
  EXPECT_EQ(orders.history().lost, 30);
  LostOrders others{ResponseSettings{}};
  others.restore({.orders = UINT32_MAX, .judged = INT16_MIN, .lost = 9}, kFirstUtcS);
  EXPECT_EQ(others.history(), LostOrderHistory{});
}

/// A pause only shortens after orders have lasted: every third one lost, with good ones between.
TEST(LostOrders, PausesGrowUntilOrdersHold) {
  Supervision supervision({});
  std::int64_t number = 0;
  std::int64_t utc_s = kFirstUtcS;
  std::int32_t soc_e4 = 5'000;
  const auto observe = [&](OrderOutcome outcome, bool own = false) {
    Response now = reading(++number, outcome, soc_e4 < 5'000 ? kW : -kW);
    now.steady_s = utc_s += kSecondsPerStep;
    if (own) now.measurement.power_w = 0;
    soc_e4 += now.measurement.power_w / 24;  // of 8 kWh, in two minutes
    now.measurement.soc_e4 = soc_e4;
    now.is_driven = now.is_driven && !own;
    now.measurement.dispatch_active = now.measurement.dispatch_active && !own;
    supervision.observe(now, own);
  };
  const auto paused_cycles = [&] {
    while (!supervision.stop_reason()) {
      observe(number % 3 == 2 ? OrderOutcome::kReplaced : OrderOutcome::kHolds);
    }
    int cycles = 0;
    for (; supervision.stop_reason() == Reason::kOtherMaster; ++cycles)
      observe(OrderOutcome::kHolds, true);
    return cycles;
  };
  EXPECT_EQ(paused_cycles(), 5);
  EXPECT_EQ(paused_cycles(), 10);
  EXPECT_EQ(paused_cycles(), 20);
  for (int i = 0; i < 10; ++i) observe(OrderOutcome::kHolds);
  EXPECT_EQ(paused_cycles(), 5);
}

}  // namespace
}  // namespace bess
