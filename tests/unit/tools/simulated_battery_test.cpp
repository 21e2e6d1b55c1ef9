// Simulated battery: exact integration, limits, expiry; for its registers see map_day_test.
#include "tools/simulators/battery_sim/simulated_battery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shared/local_time.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::int64_t kStartS = 1'679'788'800;
constexpr std::int64_t kStartNs = kStartS * kNanosecondsPerSecond;
constexpr BatteryParameters kHouse{.power_w_max = 4'000, .capacity_wh = 8'000};

constexpr std::int64_t after_s(double seconds) {
  return kStartNs + static_cast<std::int64_t>(seconds * 1e9);
}

TEST(SimulatedBattery, ReportsEveryOrderAndItsEnd) {
  using enum DispatchEvent::Kind;
  SimulatedBattery battery(kHouse, 0.5, kStartNs);
  battery.start_dispatch(1'000, 1.0, 300);
  battery.advance(after_s(60));
  battery.start_dispatch(-2'000, 0.1, 300);
  battery.stop_dispatch();
  battery.stop_dispatch();  // nothing is left to stop
  battery.advance(after_s(120));
  battery.start_dispatch(500, 1.0, 30);
  battery.advance(after_s(600));
  const std::vector<DispatchEvent>& events = battery.dispatch_events();
  ASSERT_EQ(events.size(), 5U);
  const DispatchEvent::Kind kinds[] = {kOrder, kOrder, kStop, kOrder, kExpiry};
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].kind, kinds[i]) << i;
  EXPECT_EQ(events[1].power_w, -2'000);
  EXPECT_EQ(events[1].duration_s, 300);
  EXPECT_EQ(events[4].utc_ns, after_s(150));
}

TEST(SimulatedBattery, KnowsItsColdHoursByItsOwnClock) {
  set_market_time_zone();
  BatteryParameters cold = kHouse;
  cold.cold = {.power_share = 0.6, .from_hour = 23, .to_hour = 1.25};
  SimulatedBattery battery(cold, 0.5, kStartNs);
  ASSERT_EQ(local_minute_of(kStartS).minute_of_day, 60);
  battery.start_dispatch(4'000, 1.0, 3'600);
  EXPECT_EQ(battery.power_w(), 2'400);
  EXPECT_EQ(battery.derating(), 0.6);
  battery.advance(after_s(900));
  EXPECT_NEAR(battery.soc_frac(), 0.5 + 2'400 * 0.25 * kHouse.charge_efficiency / 8'000, 1e-9);
  EXPECT_EQ(battery.derating(), 1);
  EXPECT_EQ(battery.power_w(), 4'000);
}

TEST(SimulatedBattery, GivesAndShowsNoMoreThanTheDeratingAllows) {
  SimulatedBattery battery(kHouse, 0.5, kStartNs);
  battery.set_derating(0.5);
  battery.start_dispatch(4'000, 1.0, 300);
  EXPECT_EQ(battery.power_w(), 2'000);
  EXPECT_EQ(battery.commanded_power_w(), 4'000);
}

/// A day of drawn orders: simulated by the second, and by the model's steps.
TEST(SimulatedBattery, ARealOneMovesWhatTheModelOfTheEnvironmentSays) {
  BatteryParameters real = kHouse;
  real.charge_taper = {.width_frac = 0.1, .share = 0.2};
  real.discharge_taper = {.width_frac = 0.05, .share = 0.3};
  real.full_power_loss_frac = 0.03;
  BatteryParameters slow = real;
  slow.response = {.delay_s = 2, .ramp_w_per_s = 13.3, .time_constant_s = 3};
  for (const BatteryParameters& battery : {real, slow}) {
    SimulatedBattery simulated(battery, 0.5, kStartNs);
    std::minstd_rand random(7);
    double soc_frac = 0.5;
    PowerState power;
    std::vector<double> modelled_wh;
    for (int step = 0; step < 720; ++step) {
      const int trend = (step / 90) % 2 == 0 ? 1 : -1;  // three hours each way, as with real prices
      const double wanted_w = random() % 4 == 0 ? 0 : trend * 4'000.0;
      simulated.start_dispatch(wanted_w, wanted_w > 0 ? 1.0 : 0.1, 300);
      simulated.advance(after_s(120.0 * (step + 1)));
      const ResponseStep moved = response_step(battery, soc_frac, power, wanted_w, 1.0 / 30);
      soc_frac = moved.step.soc_frac;
      power = moved.power;
      modelled_wh.push_back(moved.step.power_w / 30);
    }
    const std::vector<MinuteRecord> minutes = simulated.record();
    double moved_wh = 0, apart_wh = 0;
    for (std::size_t step = 0; step < modelled_wh.size(); ++step) {
      const double wh = minutes[2 * step].energy_wh + minutes[2 * step + 1].energy_wh;
      moved_wh += std::abs(wh);
      apart_wh += std::abs(wh - modelled_wh[step]);
    }
    EXPECT_GT(moved_wh, 30'000);
    EXPECT_LT(apart_wh, 0.03 * moved_wh);
    EXPECT_NEAR(simulated.soc_frac(), soc_frac, 0.02);
  }
}

/// The limit of the taper falls faster than a lag follows at first: the ramp must not wait for it.
TEST(SimulatedBattery, ARampTurnsWithinTheTaperAsWell) {
  BatteryParameters battery = kHouse;
  battery.charge_taper = {.width_frac = 0.1, .share = 0.2};
  battery.discharge_taper = {.width_frac = 0.1, .share = 0.2};
  battery.response = {.delay_s = 2, .ramp_w_per_s = 60, .time_constant_s = 3};
  for (const double way : {1.0, -1.0}) {
    SimulatedBattery simulated(battery, way > 0 ? 0.92 : 0.18, kStartNs);
    simulated.start_dispatch(way * 4'000, way > 0 ? 1.0 : 0.1, 300);
    simulated.advance(after_s(90));
    const double tapered_w = way * simulated.power_w();
    EXPECT_GT(tapered_w, 500) << way;
    EXPECT_LT(tapered_w, 3'700) << way;
    simulated.start_dispatch(-way * 4'000, way > 0 ? 0.1 : 1.0, 300);
    simulated.advance(after_s(90 + 2 + (tapered_w + 4'000) / 60 + 5 * 3));
    EXPECT_NEAR(simulated.power_w(), -way * 4'000, 50) << way;
  }
}

TEST(SimulatedBattery, ItsOwnConsumptionFlowsAtRestAndAtWork) {
  BatteryParameters battery = kHouse;
  battery.standby_w = 40;
  SimulatedBattery simulated(battery, 0.5, kStartNs);
  EXPECT_EQ(simulated.power_w(), 40);
  simulated.start_dispatch(-1'000, 0.1, 300);
  EXPECT_EQ(simulated.power_w(), -960);
  simulated.advance(after_s(60));
  EXPECT_NEAR(simulated.record().front().energy_wh, -16, 1e-9);
  EXPECT_NEAR(simulated.soc_frac(), 0.5 - 1'000 / std::sqrt(0.9) / 60 / 8'000, 1e-12);
}

TEST(SimulatedBattery, IntegratesTheSameInOneStepAndInMany) {
  SimulatedBattery coarse(kHouse, 0.5, kStartNs);
  SimulatedBattery fine(kHouse, 0.5, kStartNs);
  coarse.start_dispatch(4'000, 1.0, 100'000);
  fine.start_dispatch(4'000, 1.0, 100'000);
  coarse.advance(after_s(1'800));
  for (int i = 1; i <= 18'000; ++i) fine.advance(after_s(i * 0.1));
  EXPECT_NEAR(coarse.soc_frac(), 0.5 + 4'000 * std::sqrt(0.9) * 0.5 / 8'000, 1e-12);
  EXPECT_NEAR(fine.soc_frac(), coarse.soc_frac(), 1e-9);
}

TEST(SimulatedBattery, DispatchExpiresExactlyAndThenRests) {
  SimulatedBattery battery(kHouse, 0.5, kStartNs);
  battery.start_dispatch(-4'000, 0.1, 300);
  battery.advance(after_s(299.999));
  EXPECT_TRUE(battery.dispatch_active());
  EXPECT_EQ(battery.power_w(), -4'000);
  battery.advance(after_s(3'600));
  EXPECT_FALSE(battery.dispatch_active());
  EXPECT_EQ(battery.power_w(), 0);
  EXPECT_NEAR(battery.soc_frac(), 0.5 - 4'000 / std::sqrt(0.9) / 12 / 8'000, 1e-12);
}

TEST(SimulatedBattery, SocLimitIsACeilingOrAFloor) {
  SimulatedBattery battery(kHouse, 0.5, kStartNs);
  battery.start_dispatch(4'000, 0.6, 100'000);
  battery.advance(after_s(7'200));
  EXPECT_DOUBLE_EQ(battery.soc_frac(), 0.6);
  battery.start_dispatch(-4'000, 0.3, 100'000);
  battery.advance(after_s(20'000));
  EXPECT_DOUBLE_EQ(battery.soc_frac(), 0.3);
}

TEST(SimulatedBattery, RecordHasOneRowAMinuteAndAllTheEnergy) {
  SimulatedBattery battery(kHouse, 0.5, after_s(30));
  battery.start_dispatch(1'200, 1.0, 100'000);
  battery.advance(after_s(150));
  const std::vector<MinuteRecord> rows = battery.record();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].minute_utc_s, kStartS);
  EXPECT_EQ(rows[2].minute_utc_s, kStartS + 120);
  EXPECT_NEAR(rows[0].energy_wh, 10, 1e-9);  // half a minute
  EXPECT_NEAR(rows[1].energy_wh, 20, 1e-9);
  EXPECT_NEAR(rows[2].energy_wh, 10, 1e-9);  // in progress
  EXPECT_EQ(rows[1].commanded_power_w, 1'200);
}

}  // namespace
}  // namespace bess
