// Value faults of the simulated battery, as the edge sees them, and the schedule of all faults.
#include "tools/simulators/battery_sim/battery_faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "edge/device/battery/modbus_battery.h"
#include "tests/unit/tools/loopback_battery.h"

namespace bess {
namespace {

constexpr PowerOrder kTrustingOrder{
    .power_w = 4'000, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 86'400};

double energy_wh(const SimulatedBattery& battery) {
  double sum_wh = 0;
  for (const MinuteRecord& minute : battery.record()) sum_wh += minute.energy_wh;
  return sum_wh;
}

constexpr BatteryParameters kWithoutLosses{.power_w_max = 4'000,
                                           .capacity_wh = 8'000,
                                           .charge_efficiency = 1,
                                           .discharge_efficiency = 1,
                                           .soc_min_frac = 0};

TEST(BatteryFaults, EveryFaultHasItsPlaceInTheTable) {
  int value = 0;
  for (const BatteryFaultInfo& info : battery_faults()) {
    EXPECT_EQ(static_cast<int>(info.fault), ++value) << info.name;
    EXPECT_TRUE(info.tcp || info.rtu) << info.name;
  }
  EXPECT_EQ(value, static_cast<int>(BatteryFault::kGridOtherPhase));
}

TEST(BatteryFaults, ThrottleLetsAQuarterFlowNearTheLimit) {
  SimulatedBattery battery(kWithoutLosses, 0.94, 0);
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

TEST(BatteryFaults, ASlowRampTakesItsTimeFromOrderToOrder) {
  SimulatedBattery battery(kWithoutLosses, 0.5, 0);
  battery.set_habits({.ramp_w_per_s = 30});
  battery.start_dispatch(3'000, 1.0, 100'000);
  battery.advance(50 * kNanosecondsPerSecond);
  EXPECT_NEAR(battery.power_w(), 1'500, 31);
  battery.advance(200 * kNanosecondsPerSecond);
  EXPECT_NEAR(battery.power_w(), 3'000, 1e-9);
  EXPECT_NEAR(battery.soc_frac(), 0.5 + 3'000 * 150.0 / 3'600 / 8'000, 1e-4);
  battery.start_dispatch(-3'000, 0.0, 100'000);
  battery.advance(300 * kNanosecondsPerSecond);
  EXPECT_NEAR(battery.power_w(), 0, 31);  // half way
  battery.stop_dispatch();
  battery.advance(310 * kNanosecondsPerSecond);
  EXPECT_EQ(battery.power_w(), 0);
}

/// By hand: 1 - exp(-t / 5 s), behind a delay, behind a ramp, and independent of the query times.
TEST(BatteryFaults, ATimeConstantIsAnExponentialBehindDelayAndRamp) {
  for (const std::int64_t look_ms : {5'000, 250}) {
    SimulatedBattery battery(kWithoutLosses, 0.5, 0);
    battery.set_time_constant(5);
    battery.set_habits({.delay_s = 2});
    battery.start_dispatch(3'000, 1.0, 100'000);
    for (std::int64_t ms = 0; ms <= 7'000; ms += look_ms) battery.advance(ms * 1'000'000);
    battery.advance(7 * kNanosecondsPerSecond);
    EXPECT_NEAR(battery.power_w(), 3'000 * (1 - std::exp(-1.0)), 2);
    battery.advance(100 * kNanosecondsPerSecond);
    EXPECT_EQ(battery.power_w(), 3'000);
    EXPECT_NEAR(battery.soc_frac(), 0.5 + 3'000 * (100 - 2 - 5.0) / 3'600 / 8'000, 1e-5);
  }
  SimulatedBattery ramped(kWithoutLosses, 0.5, 0);
  ramped.set_time_constant(5);
  ramped.set_habits({.ramp_w_per_s = 100});
  ramped.start_dispatch(3'000, 1.0, 100'000);
  ramped.advance(25 * kNanosecondsPerSecond);
  EXPECT_NEAR(ramped.power_w(), 100 * (25 - 5 * (1 - std::exp(-5.0))), 5);
}

TEST(BatteryFaults, AHiddenDrainEmptiesTheCellsAndShowsNothing) {
  SimulatedBattery battery(kWithoutLosses, 0.5, 0);
  battery.set_habits({.hidden_drain_w = 1'000});
  battery.start_dispatch(0, 1.0, 100'000);
  battery.advance(3'600 * kNanosecondsPerSecond);
  EXPECT_EQ(battery.power_w(), 0);
  EXPECT_NEAR(battery.soc_frac(), 0.5 - 0.125, 1e-9);
  EXPECT_EQ(energy_wh(battery), 0);
}

TEST(BatteryFaults, AForcedChargeEndsAboveWhereItBegan) {
  SimulatedBattery battery(kWithoutLosses, 0.099, 0);
  battery.set_habits({.forced_charge_w = 500});
  battery.start_dispatch(0, 1.0, 100'000);
  battery.advance(60 * kNanosecondsPerSecond);
  EXPECT_EQ(battery.power_w(), 500);
  battery.advance(3'600 * kNanosecondsPerSecond);
  EXPECT_EQ(battery.power_w(), 0);
  EXPECT_NEAR(battery.soc_frac(), 0.11, 2e-4);
}

TEST(BatteryFaults, BalancingBurnsPowerWhileItIsFull) {
  SimulatedBattery battery(kWithoutLosses, 1.0, 0);
  battery.set_habits({.balancing_w = 450});
  battery.start_dispatch(0, 1.0, 100'000);
  battery.advance(3'600 * kNanosecondsPerSecond);
  EXPECT_EQ(battery.power_w(), 450);
  EXPECT_EQ(battery.soc_frac(), 1);
  EXPECT_NEAR(energy_wh(battery), 450, 1e-6);
  battery.start_dispatch(-1'000, 0.1, 100'000);
  EXPECT_EQ(battery.power_w(), -1'000);
}

/// Twelve minutes of 4 kW from 50 %: shown and true change, as a share of a healthy battery's.
TEST(BatteryFaults, DisplayFaultsMatchTheirNames) {
  struct Row {
    BatteryFault fault;
    std::int32_t shown_power_w;
    double shown, moved;
    double offset_frac = 0;
  };
  for (const Row& row :
       {Row{BatteryFault::kEcho, 4'000, 0, 0}, Row{BatteryFault::kHalfFlow, 4'000, 0.5, 0.5},
        Row{BatteryFault::kInverted, -4'000, -1 / 0.9, -1 / 0.9},
        Row{BatteryFault::kSocInverted, 4'000, -1, 1},
        Row{BatteryFault::kSocRecalibrates, 4'000, 1, 1, 0.06}}) {
    SCOPED_TRACE(battery_faults()[static_cast<std::size_t>(row.fault) - 1].name);
    BatteryServerSettings settings;
    settings.faults = {.faults = {row.fault}, .every = 1};
    LoopbackBattery loopback("block", settings);
    ModbusBattery battery(loopback.link(1'000), loopback.map, loopback.clock);
    BatteryMeasurement m;
    ASSERT_EQ(battery.read(m), Status::kOk);
    ASSERT_EQ(battery.order(kTrustingOrder), Status::kOk);
    const std::int64_t start_ns = loopback.clock.now_utc_ns();
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond * 72 / 100);
    ASSERT_EQ(battery.read(m), Status::kOk);
    const double hours = static_cast<double>(loopback.clock.now_utc_ns() - start_ns) / 3.6e12;
    const double honest_frac = hours * 4'000 * std::sqrt(0.9) / 8'000;
    EXPECT_EQ(m.power_w, row.shown_power_w);
    EXPECT_NEAR(m.soc_e4 / 1e4, 0.5 + row.shown * honest_frac + row.offset_frac, 0.01);
    EXPECT_NEAR(loopback.stop().soc_frac(), 0.5 + row.moved * honest_frac, 0.01);
  }
}

TEST(FaultPlan, ComesAndGoesWithinItsSpan) {
  FaultPlan plan({.faults = {BatteryFault::kInverted}, .from_s = 60, .on_s = 120, .off_s = 240},
                 false);
  for (const double at_s : {0.0, 59.0, 180.0, 300.0, 419.0, 540.0}) {
    EXPECT_FALSE(plan.lasts(BatteryFault::kInverted, at_s)) << at_s;
  }
  for (const double at_s : {60.0, 179.0, 420.0, 539.0, 780.0}) {
    EXPECT_TRUE(plan.lasts(BatteryFault::kInverted, at_s)) << at_s;
  }
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

TEST(FaultPlan, OfSeveralEachHasItsSpanAndItsChances) {
  FaultPlan plan({FaultSchedule{.faults = {BatteryFault::kDrop}, .every = 2, .to_s = 10},
                  FaultSchedule{.faults = {BatteryFault::kAlarm}, .from_s = 20},
                  FaultSchedule{.faults = {BatteryFault::kReset}, .every = 1, .from_s = 5}},
                 false);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 1), BatteryFault::kNone);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 2), BatteryFault::kDrop);
  EXPECT_EQ(plan.struck(), 0U);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 6), BatteryFault::kReset);
  EXPECT_EQ(plan.struck(), 2U);
  EXPECT_EQ(plan.draw(FaultChance::kRead, 7), BatteryFault::kDrop) << "of two, the first";
  EXPECT_FALSE(plan.lasts(BatteryFault::kAlarm, 7));
  EXPECT_TRUE(plan.lasts(BatteryFault::kAlarm, 20));
  EXPECT_EQ(plan.period_s(), 0);
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
