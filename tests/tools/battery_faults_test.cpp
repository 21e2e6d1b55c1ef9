// The simulated battery's faults of values, as the edge sees them, and the schedule of all faults.
#include "tools/battery_sim/battery_faults.h"

#include <gtest/gtest.h>

#include "edge/battery/modbus_battery.h"
#include "tests/tools/loopback_battery.h"

namespace bess {
namespace {

constexpr PowerOrder kTrustingOrder{
    .power_w = 4'000, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 86'400};

BatteryServerSettings always(BatteryFault fault) {
  BatteryServerSettings settings;
  settings.faults = {.faults = {fault}, .every = 1};
  return settings;
}

TEST(BatteryFaults, EveryFaultHasItsPlaceInTheTable) {
  int value = 0;
  for (const BatteryFaultInfo& info : battery_faults()) {
    EXPECT_EQ(static_cast<int>(info.fault), ++value) << info.name;
    EXPECT_TRUE(info.tcp || info.rtu) << info.name;
  }
  EXPECT_EQ(value, static_cast<int>(BatteryFault::kOtherMaster));
}

TEST(BatteryFaults, WrongSignShowsChargingAsDischarging) {
  LoopbackBattery loopback("block", always(BatteryFault::kWrongSign));
  ModbusBattery battery(loopback.link(1'000), loopback.map, loopback.clock);
  BatteryMeasurement m;
  ASSERT_EQ(battery.order(kTrustingOrder), Status::kOk);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.power_w, -4'000);
  EXPECT_EQ(loopback.stop().power_w(), 4'000);
}

TEST(BatteryFaults, SocJumpShowsHalfTheScaleMore) {
  LoopbackBattery loopback("block", always(BatteryFault::kSocJump));
  ModbusBattery battery(loopback.link(1'000), loopback.map, loopback.clock);
  BatteryMeasurement m;
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.soc_e4, 0);  // 50 % + 50 %
}

TEST(BatteryFaults, FrozenShowsWhatOnceWas) {
  BatteryServerSettings settings = always(BatteryFault::kFrozen);
  settings.faults.from_s = 200;
  LoopbackBattery loopback("block", settings);
  ModbusBattery battery(loopback.link(1'000), loopback.map, loopback.clock);
  BatteryMeasurement before, after;
  ASSERT_EQ(battery.order(kTrustingOrder), Status::kOk);
  ASSERT_EQ(battery.read(before), Status::kOk);
  sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond);  // 1000 s
  ASSERT_EQ(battery.read(after), Status::kOk);
  EXPECT_NEAR(after.soc_e4, before.soc_e4, 100);  // the last good answer was a little later
  EXPECT_GT(loopback.stop().soc_frac(), 0.6);
}

TEST(BatteryFaults, EarlyExpiryEndsTheOrderAndIsSeen) {
  BatteryServerSettings settings = always(BatteryFault::kEarlyExpiry);
  settings.faults.every = 4;  // the read-back of the order is not struck
  LoopbackBattery loopback("block", settings);
  ModbusBattery battery(loopback.link(1'000), loopback.map, loopback.clock);
  BatteryMeasurement m;
  ASSERT_EQ(battery.order(kTrustingOrder), Status::kOk);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_FALSE(m.dispatch_active);
  EXPECT_FALSE(loopback.stop().dispatch_active());
}

TEST(BatteryFaults, ThrottleLetsAQuarterFlowNearTheLimit) {
  SimulatedBattery battery({.power_w_max = 4'000,
                            .capacity_wh = 8'000,
                            .charge_efficiency = 1,
                            .discharge_efficiency = 1},
                           0.94, 0);
  battery.set_habits({.slows_near_limits = true});
  battery.start_dispatch(4'000, 1.0, 100'000);
  EXPECT_EQ(battery.power_w(), 4'000);
  battery.advance(72 * kNanosecondsPerSecond);  // 80 Wh to 95 %
  EXPECT_NEAR(battery.soc_frac(), 0.95, 0.0002);
  EXPECT_EQ(battery.power_w(), 1'000);
  battery.advance(432 * kNanosecondsPerSecond);  // 100 Wh more
  EXPECT_NEAR(battery.soc_frac(), 0.9625, 0.0005);
  battery.start_dispatch(-4'000, 0.1, 100'000);
  EXPECT_EQ(battery.power_w(), -4'000);  // away from the limit
}

TEST(FaultPlan, StrikesEveryNthChanceWithinItsSpan) {
  FaultPlan plan({.faults = {BatteryFault::kDrop}, .every = 3, .from_s = 10, .to_s = 20}, false);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 9), BatteryFault::kNone);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 10), BatteryFault::kNone);
  EXPECT_EQ(plan.draw(FaultChance::kWrite, 10), BatteryFault::kNone);
  EXPECT_EQ(plan.draw(FaultChance::kConnect, 10), BatteryFault::kNone);  // no chance for a drop
  EXPECT_EQ(plan.draw(FaultChance::kRead, 10), BatteryFault::kDrop);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(plan.draw(FaultChance::kRead, 20), BatteryFault::kNone);
}

TEST(FaultPlan, DrawsByProbabilityTheSameForTheSameSeed) {
  const FaultSchedule schedule{
      .faults = {BatteryFault::kSilence, BatteryFault::kBadCrc}, .probability = 0.25, .seed = 5};
  FaultPlan one(schedule, true), other(schedule, true), tcp(schedule, false);
  int struck = 0;
  for (int i = 0; i < 4'000; ++i) {
    const BatteryFault fault = one.draw(FaultChance::kRead, 0);
    EXPECT_EQ(fault, other.draw(FaultChance::kRead, 0));
    EXPECT_NE(tcp.draw(FaultChance::kRead, 0), BatteryFault::kBadCrc);  // TCP has none
    if (fault != BatteryFault::kNone) ++struck;
  }
  EXPECT_NEAR(struck, 1'000, 150);
}

}  // namespace
}  // namespace bess
