// Sign check against the simulator's physics: what passes, what is refused, and that the battery is
// released on every exit.
#include "edge/device/battery/commission.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/support/fake_plant.h"

namespace bess {
namespace {

/// A meter at the connection, and a house with a moving load.
struct CommissionMeter {
  [[nodiscard]] static bool exists() { return true; }
  Status read(const BatteryMeasurement&, std::int32_t& grid_power_w) {
    if (is_silent) return Status::kTimeout;
    battery.physics.advance(battery.clock.now_ns);
    grid_power_w = static_cast<std::int32_t>(
        shown(house_w(battery.clock.now_ns / kNanosecondsPerSecond) + battery.physics.power_w()));
    return Status::kOk;
  }
  FakeBattery& battery;
  std::function<double(double)> shown = [](double grid_w) { return grid_w; };
  std::function<double(std::int64_t)> house_w = [](std::int64_t) { return 400.0; };
  bool is_silent = false;
};

struct CommissionSite {
  explicit CommissionSite(double soc = 0.3, const BatteryHabits& habits = {})
      : battery(clock, soc) {
    battery.physics.set_habits(habits);
  }
  explicit CommissionSite(const BatteryHabits& habits) : CommissionSite(0.3, habits) {}
  CommissionResult commission(const CommissionSettings& settings = {}) {
    return SignCheck<FakeBattery, FakeClock>(settings, battery, clock).run();
  }
  CommissionResult passes(const CommissionSettings& settings = {}) {
    CommissionResult result = commission(settings);
    EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
    return result;
  }
  CommissionResult commission_with(const CommissionMeter& meter) {
    return SignCheck<FakeBattery, FakeClock, CommissionMeter>({}, battery, clock, meter).run();
  }
  void expect_refused(CommissionVerdict verdict) {
    EXPECT_EQ(commission().verdict, verdict) << commission_text(verdict);
    EXPECT_FALSE(battery.physics.dispatch_active());
  }
  [[nodiscard]] std::vector<int> ordered() const {
    std::vector<int> watts;
    for (const PowerOrder& order : battery.orders) watts.push_back(order.power_w);
    return watts;
  }

  FakeClock clock;
  FakeBattery battery;
};

TEST(Commission, DrivesABatteryBothWays) {
  CommissionSite site(0.3);
  const std::int64_t start_ns = site.clock.now_ns;
  const CommissionResult result = site.passes();
  EXPECT_TRUE(result.charge.is_tested && result.discharge.is_tested);
  EXPECT_EQ(result.charge.measured_power_w, 500);
  EXPECT_EQ(result.discharge.measured_power_w, -500);
  EXPECT_EQ(result.charge.speed.dynamics.dead_time_s, 0);
  EXPECT_EQ(ramp_w_per_s(result.charge.speed), 0);
  EXPECT_EQ(site.ordered(), (std::vector{0, 500, 0, -500, 0, 4'000, -4'000, 4'000, 0}));
  EXPECT_EQ(site.battery.releases, 1);
  EXPECT_EQ((site.clock.now_ns - start_ns) / kNanosecondsPerSecond,
            10 + 30 + 10 + 30 + 10 + 3 * 8 + 10);
}

TEST(Commission, SaysWhichDirectionItsSocDoesNotLeave) {
  CommissionSite full(1.0);
  const CommissionResult discharged = full.passes();
  EXPECT_FALSE(discharged.charge.is_tested);
  EXPECT_EQ(discharged.discharge.measured_power_w, -500);
  EXPECT_EQ(full.ordered(), (std::vector{0, -500, 0, -4'000, 0}));
  CommissionSite empty(0.1);
  const CommissionResult charged = empty.passes();
  EXPECT_FALSE(charged.discharge.is_tested);
  CommissionSite between(0.5);
  EXPECT_EQ(between.commission({.soc_min_e4 = 4'950, .soc_max_e4 = 5'050}).verdict,
            CommissionVerdict::kNoRoom);
  EXPECT_TRUE(between.battery.orders.empty());
}

/// A step below twice the small one does not separate a lag from a ramp.
TEST(Commission, InOneDirectionALargerStepIsAtLeastTwiceTheSmallOne) {
  CommissionSite full(1.0);
  full.passes({.rated_w = 999});
  EXPECT_EQ(full.ordered(), (std::vector{0, -500, 0}));
  CommissionSite twice(1.0);
  twice.passes({.rated_w = 1'000});
  EXPECT_EQ(twice.ordered(), (std::vector{0, -500, 0, -1'000, 0}));
}

/// 4029 W were once measured for 500, and "the sign is right".
TEST(Commission, RefusesMorePowerThanOrderedAndEndsItImmediately) {
  for (const double gain : {8.06, 1.5, -8.0}) {
    CommissionSite site({.gain = gain});
    const std::int64_t start_ns = site.clock.now_ns;
    site.expect_refused(gain > 0 ? CommissionVerdict::kTooMuch : CommissionVerdict::kWrongSign);
    EXPECT_LE(site.clock.now_ns - start_ns, 13 * kNanosecondsPerSecond);
  }
}

TEST(Commission, TheOtherDirectionIsLookedAtAsWell) {
  CommissionSite site;
  site.battery.changed = [](BatteryMeasurement& m) {
    if (m.power_w < 0) m.power_w = -m.power_w;  // a map that reads a magnitude
  };
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kWrongSign);
  EXPECT_EQ(result.ordered_power_w, -500);
  EXPECT_FALSE(site.battery.physics.dispatch_active());
}

TEST(Commission, RefusesLessThanItsMapAllowsAndSaysWhatToSet) {
  CommissionSite site({.gain = 0.55});
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kTooLittle);
  EXPECT_EQ(result.wanted_tolerance_w, 300);  // 225 W are missing
  CommissionSite({.gain = 0.55}).passes({.response = {.tolerance_w = 300}});
}

TEST(Commission, MeasuresALagAndProposesTheTimeToSettle) {
  const CommissionResult passed = CommissionSite({.delay_s = 5}).passes();
  EXPECT_NEAR(passed.charge.speed.dynamics.dead_time_s, 5, 1.001);
  EXPECT_NEAR(static_cast<double>(passed.charge.came_ms), 5'000, 1'001);
  const CommissionResult refused = CommissionSite({.delay_s = 25}).commission();
  EXPECT_EQ(refused.verdict, CommissionVerdict::kSlow);
  EXPECT_GE(refused.wanted_settle_s, 25);
  EXPECT_LE(refused.wanted_settle_s, 32);
  EXPECT_EQ(refused.wanted_ramp_w_max, 0);
  CommissionSite({.delay_s = 25}).passes({.response = {.settle_s = refused.wanted_settle_s}});
}

/// 500 W are there in 17 s; a reversal of 8 kW takes 267 s, longer than any map may say.
TEST(Commission, MeasuresARampAndProposesTheStepThatItManages) {
  const CommissionResult result = CommissionSite({.ramp_w_per_s = 30}).commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kSlow);
  EXPECT_NEAR(ramp_w_per_s(result.charge.speed), 30, 2);
  EXPECT_EQ(result.wanted_settle_s, 100);
  EXPECT_NEAR(result.wanted_ramp_w_max, 2'400, 200);
  CommissionSite({.ramp_w_per_s = 30})
      .passes({.response = {.settle_s = result.wanted_settle_s},
               .step_w_max = result.wanted_ramp_w_max});
  // 500 W in 2.5 s, 8 kW in 40.
  const CommissionResult seen = CommissionSite({.ramp_w_per_s = 200}).commission();
  EXPECT_EQ(seen.verdict, CommissionVerdict::kSlow);
  EXPECT_NEAR(ramp_w_per_s(seen.discharge.speed), 200, 10);
  EXPECT_NEAR(seen.wanted_settle_s, 45, 2);  // 37 s and a fifth
  EXPECT_EQ(seen.wanted_ramp_w_max, 0);
}

/// At 11 % at most 500 W are discharged, and charged only up to the remaining room.
TEST(Commission, WhatOneStepAloneShowedIsAWarning) {
  CommissionSite site(0.12);
  site.battery.physics.set_time_constant(5);
  const CommissionResult result = site.passes();
  EXPECT_EQ(site.ordered(), (std::vector{0, 500, 0, -500, 0, 4'000, 0}));
  EXPECT_TRUE(result.charge.speed.has_two);
  EXPECT_FALSE(result.charge.speed.is_doubtful);
  EXPECT_FALSE(result.discharge.speed.has_two);
  EXPECT_TRUE(result.discharge.speed.is_doubtful);
  CommissionSite bound(0.5);
  bound.battery.physics.set_time_constant(5);
  bound.passes({.drives_further = false});
  EXPECT_EQ(bound.ordered(), (std::vector{0, 500, 0, -500, 0}));
}

TEST(Commission, TheConnectionBoundsTheLargerSteps) {
  CommissionSite site(0.5);
  const CommissionResult result = SignCheck<FakeBattery, FakeClock, CommissionMeter>(
                                      {.import_w_max = 3'000, .export_w_max = 900}, site.battery,
                                      site.clock, {.battery = site.battery})
                                      .run();
  EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
  // 400 W of house: 2600 W are left to charge, 1300 W to discharge.
  EXPECT_EQ(site.ordered(), (std::vector{0, 500, 0, -500, 0, 1'300, -1'300, 1'300, 0}));
}

/// Near its limits it reduces power: that is no ramp, and does not show its speed.
TEST(Commission, ABatteryThatHoldsBackIsNotSlow) {
  CommissionSite site(0.5);
  site.battery.physics.set_derating(0.4);
  const CommissionResult result = site.passes();
  EXPECT_TRUE(result.charge.is_held_back);
  EXPECT_EQ(result.charge.further_measured_w, 1'600);
  EXPECT_FALSE(result.charge.speed.has_two);
  EXPECT_EQ(site.ordered(), (std::vector{0, 500, 0, -500, 0, 4'000, 0}));
}

TEST(Commission, AnAlarmDuringTheCheckEndsIt) {
  CommissionSite site;
  site.battery.changed = [&](BatteryMeasurement& m) {
    m.alarm = site.battery.physics.power_w() != 0;
  };
  EXPECT_EQ(site.commission().verdict, CommissionVerdict::kAlarm);
  EXPECT_EQ(site.battery.releases, 1);
  EXPECT_EQ(site.battery.orders.size(), 2U);
}

// --- the meter -----------------------------------------------------------------------------------

TEST(Commission, AMeterThatFollowsPasses) {
  CommissionSite site;
  const CommissionResult result = site.commission_with({.battery = site.battery});
  EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
  EXPECT_EQ(result.meter, MeterVerdict::kFollows);
  EXPECT_EQ(result.meter_percent, 100);
  EXPECT_EQ(result.rest_house_w, 400);
  CommissionSite full(1.0);
  EXPECT_EQ(full.commission_with({.battery = full.battery}).meter, MeterVerdict::kFollows);
  CommissionSite kettle;  // switched on in one of the four steps
  CommissionMeter meter{.battery = kettle.battery};
  const std::int64_t on_s = kettle.clock.now_ns / kNanosecondsPerSecond + 60;
  meter.house_w = [on_s](std::int64_t utc_s) { return utc_s < on_s ? 400.0 : 2'400.0; };
  EXPECT_EQ(kettle.commission_with(meter).verdict, CommissionVerdict::kPassed);
}

TEST(Commission, AMeterThatDoesNotFollowIsRefused) {
  const std::function<double(double)> liars[] = {
      [](double) { return 400.0; }, [](double w) { return -w; }, [](double w) { return 0.1 * w; },
      [](double w) { return 10 * w; }, [](double w) { return 0.65 * w; }};
  for (const auto& lie : liars) {
    CommissionSite site;
    const CommissionResult result = site.commission_with({.battery = site.battery, .shown = lie});
    EXPECT_EQ(result.verdict, CommissionVerdict::kMeterMismatch) << result.meter_percent;
    EXPECT_EQ(site.battery.releases, 1);
  }
  CommissionSite silent;
  const CommissionResult lost =
      silent.commission_with({.battery = silent.battery, .is_silent = true});
  EXPECT_EQ(lost.verdict, CommissionVerdict::kMeterLost);
  EXPECT_EQ(lost.status, Status::kTimeout);
}

TEST(Commission, AHouseThatMovesTooMuchIsNoReasonToAccuse) {
  CommissionSite site;
  CommissionMeter meter{.battery = site.battery};
  meter.house_w = [](std::int64_t utc_s) { return static_cast<double>(utc_s * 7'919 % 13) * 300; };
  EXPECT_EQ(site.commission_with(meter).verdict, CommissionVerdict::kMeterRestless);
}

TEST(Commission, RefusesABatteryThatDoesNothing) {
  CommissionSite site;
  site.battery.physics =
      SimulatedBattery({.power_w_max = 1, .capacity_wh = 8'000}, 0.3, site.clock.now_ns);
  site.expect_refused(CommissionVerdict::kDoesNotFollow);
}

TEST(Commission, RefusesWrongSignsAndAnInterruptAndAnAlarmWithoutOrderingAnything) {
  CommissionSite reversed, alarmed, interrupted;
  reversed.battery.inverted = true;
  reversed.expect_refused(CommissionVerdict::kWrongSign);
  alarmed.battery.alarm = true;
  alarmed.expect_refused(CommissionVerdict::kAlarm);
  EXPECT_TRUE(alarmed.battery.orders.empty());
  interrupted.clock.stop = true;
  interrupted.expect_refused(CommissionVerdict::kInterrupted);
}

TEST(Commission, RefusesABatteryThatFollowsAnotherController) {
  CommissionSite site;
  site.battery.physics.start_dispatch(1'000, 1.0, 3'600);
  EXPECT_EQ(site.commission().verdict, CommissionVerdict::kForeignOrder);
  EXPECT_TRUE(site.battery.orders.empty());
  EXPECT_EQ(site.battery.releases, 0);  // an order of another controller is not released
}

TEST(Commission, RefusesPowerAtRest) {
  CommissionSite site;
  site.battery.offset_w = 400;
  site.expect_refused(CommissionVerdict::kNotAtRest);
  EXPECT_EQ(site.battery.orders.size(), 1U);  // only 0 W
}

TEST(Commission, SaysWhyTheLinkFailed) {
  CommissionSite site;
  site.battery.link = false;
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kNoLink);
  EXPECT_EQ(result.status, Status::kTimeout);
}

TEST(Commission, TriesAgainToReleaseAndSaysWhenItCannot) {
  CommissionSite site;
  site.battery.failing_releases = 3;
  CommissionResult result = site.passes();
  EXPECT_FALSE(site.battery.physics.dispatch_active());
  site.battery.inverted = true;
  site.battery.failing_releases = 1'000;
  result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kWrongSign);
  EXPECT_EQ(result.release_status, Status::kTimeout);
}

TEST(Commission, RefreshesTheWatchdog) {
  CommissionSite site;
  site.battery.refresh_s = 9;
  site.passes();
  EXPECT_EQ(site.battery.refreshed_ns.size(), 4 * 1U + 2 * 3U);  // 10 s of rest, 30 s of driving
}

}  // namespace
}  // namespace bess
