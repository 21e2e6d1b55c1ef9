// A day of orders through the driver and the simulated battery of every shipped map and variant, in
// moved time: the flowing energy equals the ordered energy, watchdogs are refreshed while the
// controller runs and end the order when it dies.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/image_device.h"

namespace bess {
namespace {

class EveryMap : public ::testing::TestWithParam<MapVariant> {
 protected:
  EveryMap() : device_(GetParam().map, GetParam().variant), t_(device_.test) {}

  /// The rest of a control cycle as in the loop: refreshes as often as the driver requests.
  void pass_cycle() {
    const int interval_s = t_.driver->refresh_interval_s();
    int left_s = 120;
    while (interval_s > 0 && left_s > interval_s) {
      t_.device.pass_s(interval_s);
      left_s -= interval_s;
      ASSERT_EQ(t_.driver->refresh(), Status::kOk);
    }
    t_.device.pass_s(left_s);
  }

  SimulatedDevice device_;
  MapUnderTest& t_;
};

TEST_P(EveryMap, EnergyIsAsOrderedForADay) {
  std::mt19937 random(7);
  double ordered_wh = 0;
  for (int cycle = 0; cycle < 720; ++cycle) {
    ASSERT_EQ(t_.read(), Status::kOk) << cycle;
    // Away from the limits, so that all orders fit.
    std::int32_t power_w = static_cast<std::int32_t>(random() % 3) * 2'000 - 2'000;
    if (t_.measured.soc_e4 > 8'000) power_w = std::min(power_w, 0);
    if (t_.measured.soc_e4 < 3'000) power_w = std::max(power_w, 0);
    const double before_wh = device_.energy_wh();
    ASSERT_EQ(t_.order(power_w), Status::kOk) << cycle;
    ASSERT_EQ(t_.read(), Status::kOk) << cycle;
    EXPECT_NEAR(t_.measured.power_w, power_w, 2) << cycle;
    ASSERT_TRUE(t_.measured.dispatch_active) << cycle;
    if (t_.measured.has_order_power) {
      EXPECT_NEAR(t_.measured.order_power_w, power_w, 2) << cycle;
    }
    pass_cycle();
    EXPECT_NEAR(device_.energy_wh() - before_wh, power_w / 30.0, 0.7) << cycle;
    ordered_wh += power_w / 30.0;
  }
  EXPECT_NEAR(device_.energy_wh(), ordered_wh, 0.002 * 720 * 2'000 / 30);
  ASSERT_EQ(t_.driver->release(), Status::kOk);
  ASSERT_EQ(t_.read(), Status::kOk);
  EXPECT_EQ(t_.measured.power_w, 0);
  EXPECT_FALSE(t_.measured.dispatch_active);
  const BatteryCounters counters = t_.driver->counters();
  EXPECT_EQ(counters.failed_requests, 0);
  EXPECT_LE(counters.flash_writes_today, 48);
}

TEST_P(EveryMap, ADeadControllerLeavesNoOrderBehind) {
  ASSERT_EQ(t_.read(), Status::kOk);
  ASSERT_EQ(t_.order(2'000), Status::kOk);
  t_.device.pass_s(1'000);
  ASSERT_EQ(t_.read(), Status::kOk);
  const bool forever = t_.map.watchdog.kind == Watchdog::Kind::kNone;
  EXPECT_EQ(t_.measured.power_w, forever ? 2'000 : 0);
  EXPECT_EQ(t_.measured.dispatch_active, forever);
  // A restarted controller brings the order into force again.
  ASSERT_EQ(t_.order(-2'000), Status::kOk);
  ASSERT_EQ(t_.read(), Status::kOk);
  EXPECT_NEAR(t_.measured.power_w, -2'000, 2);
}

TEST_P(EveryMap, ARestartTakesOverAndRestoresTheDevicesOwnMode) {
  ASSERT_EQ(t_.order(2'000), Status::kOk);
  DeviceDriver successor(t_.map, DeviceClock(t_.device), -1, t_.device);
  BatteryMeasurement m;
  ASSERT_EQ(successor.read(m), Status::kOk);
  EXPECT_NEAR(m.power_w, 2'000, 2);
  if (!t_.map.active.empty() && t_.map.watchdog.expiry_visible) {
    EXPECT_TRUE(m.dispatch_active);
    EXPECT_NEAR(m.order_power_w, 2'000, 2);
  }
  ASSERT_EQ(successor.order({.power_w = 2'000, .duration_s = t_.map.watchdog.duration_s}),
            Status::kOk);
  ASSERT_EQ(successor.read(m), Status::kOk);
  EXPECT_NEAR(m.power_w, 2'000, 2);  // no step
  ASSERT_EQ(successor.release(), Status::kOk);
  ASSERT_EQ(successor.read(m), Status::kOk);
  EXPECT_EQ(m.power_w, 0);
  // The first one's end, with the device at rest already, changes nothing.
  ASSERT_EQ(t_.driver->release(), Status::kOk);
  ASSERT_EQ(t_.read(), Status::kOk);
  EXPECT_EQ(t_.measured.power_w, 0);
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMap, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
