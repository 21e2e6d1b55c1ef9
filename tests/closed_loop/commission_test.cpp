// The sign check against the simulator's physics: what passes, what is refused, and that the
// battery is free again on every way out.
#include "edge/battery/commission.h"

#include <gtest/gtest.h>

#include "tests/support/fake_plant.h"

namespace bess {
namespace {

struct CommissionSite {
  explicit CommissionSite(double soc = 0.3) : battery(clock, soc) {}
  CommissionResult commission(const CommissionSettings& settings = {}) {
    return SignCheck<FakeBattery, FakeClock>(settings, battery, clock).run();
  }
  void expect_refused(CommissionVerdict verdict) {
    EXPECT_EQ(commission().verdict, verdict) << commission_text(verdict);
    EXPECT_FALSE(battery.physics.dispatch_active());
  }

  FakeClock clock;
  FakeBattery battery;
};

TEST(Commission, ChargesABatteryThatHasRoom) {
  CommissionSite site(0.3);
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
  EXPECT_EQ(result.ordered_power_w, 500);
  EXPECT_EQ(result.measured_power_w, 500);
  ASSERT_EQ(site.battery.orders.size(), 2U);  // rest, drive
  EXPECT_EQ(site.battery.orders[0].power_w, 0);
  EXPECT_EQ(site.battery.releases, 1);
  EXPECT_NEAR(site.battery.physics.soc_frac() - 0.3, 500.0 * 30 / 3'600 / 8'000 * 0.95, 1e-5);
}

TEST(Commission, DischargesAFullOne) {
  CommissionSite site(1.0);
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
  EXPECT_EQ(result.measured_power_w, -500);
}

TEST(Commission, RefusesAWrongSign) {
  CommissionSite site;
  site.battery.inverted = true;
  site.expect_refused(CommissionVerdict::kWrongSign);
}

TEST(Commission, RefusesABatteryThatDoesNothing) {
  CommissionSite site;
  site.battery.physics =
      SimulatedBattery({.power_w_max = 1, .capacity_wh = 8'000}, 0.3, site.clock.now_ns);
  site.expect_refused(CommissionVerdict::kDoesNotFollow);
}

TEST(Commission, RefusesAnAlarmWithoutOrderingAnything) {
  CommissionSite site;
  site.battery.alarm = true;
  site.expect_refused(CommissionVerdict::kAlarm);
  EXPECT_TRUE(site.battery.orders.empty());
}

TEST(Commission, RefusesABatteryThatFollowsSomebodyElse) {
  CommissionSite site;
  site.battery.physics.start_dispatch(1'000, 1.0, 3'600);
  EXPECT_EQ(site.commission().verdict, CommissionVerdict::kForeignOrder);
  EXPECT_TRUE(site.battery.orders.empty());
  EXPECT_EQ(site.battery.releases, 0);  // it is not ours to release
}

TEST(Commission, RefusesPowerAtRest) {
  CommissionSite site;
  site.battery.offset_w = 400;
  site.expect_refused(CommissionVerdict::kNotAtRest);
  EXPECT_EQ(site.battery.orders.size(), 1U);  // only the 0 W
}

TEST(Commission, SaysWhyTheLinkFailed) {
  CommissionSite site;
  site.battery.link = false;
  const CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kNoLink);
  EXPECT_EQ(result.status, Status::kTimeout);
}

TEST(Commission, AnInterruptReleases) {
  CommissionSite site;
  site.clock.stop = true;
  site.expect_refused(CommissionVerdict::kInterrupted);
}

TEST(Commission, TriesAgainToReleaseAndSaysWhenItCannot) {
  CommissionSite site;
  site.battery.failing_releases = 3;
  CommissionResult result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kPassed);
  EXPECT_FALSE(site.battery.physics.dispatch_active());
  site.battery.inverted = true;
  site.battery.failing_releases = 1'000;
  result = site.commission();
  EXPECT_EQ(result.verdict, CommissionVerdict::kWrongSign);
  EXPECT_EQ(result.release_status, Status::kTimeout);
}

TEST(Commission, FeedsTheWatchdogMeanwhile) {
  CommissionSite site;
  site.battery.refresh_s = 9;
  EXPECT_EQ(site.commission().verdict, CommissionVerdict::kPassed);
  EXPECT_EQ(site.battery.refreshed_ns.size(), 1U + 3U);  // 10 s of rest, 30 s of driving
}

}  // namespace
}  // namespace bess
