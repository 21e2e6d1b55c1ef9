// The supervision among healthy batteries: days of real prices on each variant, without a trip; and
// proof that each of them is as odd as its name says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <span>
#include <string_view>

#include "tests/support/thorough.h"
#include "tests/trial/trial_run.h"

namespace bess::trial {
namespace {

#ifdef BESS_SANITIZED
const int kDays = 1;
#else
const int kDays = few_or_all(3, 30);
#endif

class HonestBattery : public ::testing::TestWithParam<HonestVariant> {};

TEST_P(HonestBattery, TripsNothing) {
  const HonestDays days = live_honest_days(GetParam(), kDays);
  std::printf("%-42s %d of %d cycles lost in %d days\n", GetParam().name, days.lost_in_all(),
              days.cycles, kDays);
  EXPECT_EQ(days.trips, 0) << reason_name(days.first_trip) << " in cycle " << days.first_trip_cycle;
  EXPECT_GT(days.driven, days.cycles / 3);
  EXPECT_LT(days.wrong_energy_e6_max, WrongEnergy::kToldE6);
  EXPECT_GT(days.moved_wh, kDays * GetParam().nature.capacity_wh);
}

/// The controller is killed after so many cycles, its clock is stepped after so many.
TEST_P(HonestBattery, TripsNothingAmongKillsAndStepsOfTheClock) {
  // Slower than its map says: it may look wrong at times, and is no trip.
  const bool is_beyond_its_map = GetParam().name == std::string_view("ramp_30_w_per_s");
  const Disturbances cases[] = {{.kill_every = 1},
                                {.kill_every = 7},
                                {.kill_every = 2, .step_every = 3},
                                {.step_every = 3},
                                {.step_every = 11}};
  for (const Disturbances& often : std::span(cases).first(few_or_all(3, 5))) {
    const HonestDays days = live_honest_days(GetParam(), (kDays + 5) / 6, often);
    SCOPED_TRACE("killed after " + std::to_string(often.kill_every) + ", stepped after " +
                 std::to_string(often.step_every));
    EXPECT_EQ(days.trips, 0) << reason_name(days.first_trip) << " in cycle "
                             << days.first_trip_cycle;
    if (often.step_every == 0 || !is_beyond_its_map) {
      EXPECT_LT(days.wrong_energy_e6_max, WrongEnergy::kToldE6);
    }
    EXPECT_GT(days.driven, days.cycles / (often.step_every == 0 ? 3 : 4));
  }
}

std::string variant_name(const ::testing::TestParamInfo<HonestVariant>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Variants, HonestBattery, ::testing::ValuesIn(honest_variants()),
                         variant_name);

const HonestVariant& variant(std::string_view name) {
  for (const HonestVariant& v : honest_variants()) {
    if (name == v.name) return v;
  }
  ADD_FAILURE() << "no variant " << name;
  return honest_variants()[0];
}

Oddities odd_days(std::string_view name) { return live_honest_days(variant(name), 4).oddities; }

TEST(HonestVariants, AreAsOddAsTheyAreCalled) {
  EXPECT_GE(honest_variants().size(), 27U);
  for (const char* name : {"calibration_at_rest_small", "calibration_at_rest_large",
                           "calibration_at_ends_small", "calibration_at_ends_large"}) {
    EXPECT_GE(odd_days(name).calibrations, 2) << name;
  }
  EXPECT_GE(odd_days("restarts_of_90_s").restarts, 2);
  EXPECT_GE(odd_days("reboots_of_4_min").restarts, 1);
  EXPECT_GE(odd_days("late_replies").late_answers, 10);
  EXPECT_EQ(odd_days("derating_hidden").derated_s, 4 * 3 * 3'600);
  EXPECT_GE(odd_days("forced_charge_below_10_percent").forced_charge_s, 60);
  EXPECT_GE(odd_days("balancing_at_full").balancing_s, 60);
  EXPECT_GE(odd_days("pv_charging").sun_s, 4 * 10 * 3'600);
  const Oddities plain = odd_days("plain");
  EXPECT_EQ(plain.calibrations + plain.restarts + plain.late_answers, 0);
  EXPECT_EQ(plain.derated_s + plain.forced_charge_s + plain.balancing_s + plain.sun_s, 0);
}

/// Worked out by hand: 4 kW for an hour less the ramps, 8 kWh, 92 % there and back.
TEST(TrialBattery, FollowsAnOrderAfterItsLagAndCountsTheEnergy) {
  TrialClock clock{.now_ns = 1'700'000'000 * kNanosecondsPerSecond};
  TrialBattery battery(clock, {.standby_w = 0, .noise_frac = 0}, 0.3, 1);
  BatteryMeasurement m;
  ASSERT_EQ(battery.order({.power_w = 4'000, .duration_s = 4'000}), Status::kOk);
  clock.pause_ns(4 * kNanosecondsPerSecond);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.power_w, 0);
  clock.pause_ns(6 * kNanosecondsPerSecond);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.power_w, 4'000);
  clock.pause_ns(3'590 * kNanosecondsPerSecond);
  ASSERT_EQ(battery.read(m), Status::kOk);
  const double charged_wh = 4'000 * (1 - 7.0 / 3'600);
  EXPECT_NEAR(battery.energy().moved_wh, charged_wh, 4);
  EXPECT_NEAR(m.soc_e4 / 1e4, 0.3 + charged_wh * std::sqrt(0.92) / 8'000, 1e-3);
  EXPECT_TRUE(m.dispatch_active);
  clock.pause_ns(500 * kNanosecondsPerSecond);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_FALSE(m.dispatch_active);  // nobody renewed it
  EXPECT_EQ(m.power_w, 0);
}

}  // namespace
}  // namespace bess::trial
