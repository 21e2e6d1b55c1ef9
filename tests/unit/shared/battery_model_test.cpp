// Battery model step: energy is conserved, bounds are exact, and energy that does not fit is
// neither exchanged nor paid.
#include "shared/battery_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shared/units_and_limits.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

const double kEta = std::sqrt(0.9);

/// Stored energy for the energy exchanged with the grid [Paper, Eq. 2].
double stored_wh(const BatteryParameters& battery, double power_w, double hours) {
  return power_w > 0 ? power_w * hours * battery.charge_efficiency
                     : power_w * hours / battery.discharge_efficiency;
}

TEST(BatteryModel, FullStepsFollowTheFormula) {
  const BatteryParameters battery;
  const BatteryStep charged = battery_step(battery, 0.5, 4e6, kHoursPerStep);
  EXPECT_EQ(charged.power_w, 4e6);
  EXPECT_DOUBLE_EQ(charged.soc_frac, 0.5 + 4e6 * kEta / 30 / 8e6);
  const BatteryStep discharged = battery_step(battery, 0.5, -4e6, kHoursPerStep);
  EXPECT_EQ(discharged.power_w, -4e6);
  EXPECT_DOUBLE_EQ(discharged.soc_frac, 0.5 - 4e6 / kEta / 30 / 8e6);
  EXPECT_EQ(battery_step(battery, 0.5, 0, kHoursPerStep).soc_frac, 0.5);
}

TEST(BatteryModel, AtABoundOnlyWhatFitsIsExchanged) {
  const BatteryParameters battery;
  const BatteryStep full = battery_step(battery, 0.999, 4e6, kHoursPerStep);
  EXPECT_EQ(full.soc_frac, battery.soc_max_frac);
  EXPECT_NEAR(full.power_w, 0.001 * 8e6 / kEta * 30, 1e-6);
  const BatteryStep empty = battery_step(battery, 0.101, -4e6, kHoursPerStep);
  EXPECT_EQ(empty.soc_frac, battery.soc_min_frac);
  EXPECT_NEAR(empty.power_w, -0.001 * 8e6 * kEta * 30, 1e-6);
  EXPECT_EQ(battery_step(battery, 1.0, 4e6, kHoursPerStep).power_w, 0);
  EXPECT_EQ(battery_step(battery, 0.1, -4e6, kHoursPerStep).power_w, 0);
}

TEST(BatteryModel, OutsideTheWindowItReturnsOrRests) {
  const BatteryParameters battery;
  const struct {
    double soc_frac, wanted_w;
    bool moves;
  } cases[] = {{0.05, -4e6, false}, {0.05, 4e6, true},  {0.0, 4e6, true},
               {1.02, 4e6, false},  {1.02, -4e6, true}, {0.05, 0, false}};
  for (const auto& c : cases) {
    const BatteryStep step = battery_step(battery, c.soc_frac, c.wanted_w, kHoursPerStep);
    if (c.moves) {
      EXPECT_EQ(step.power_w, c.wanted_w) << c.soc_frac;
      EXPECT_GT((step.soc_frac - c.soc_frac) * c.wanted_w, 0) << c.soc_frac;
    } else {
      EXPECT_EQ(step.power_w, 0) << c.soc_frac;
      EXPECT_EQ(step.soc_frac, c.soc_frac);
    }
  }
}

TEST(BatteryModel, ConservesEnergyAndStaysInsideForAnyBatteryAndOrder) {
  Random random(2);
  constexpr double kRounding = 1e-12;
  for (int i = 0; i < 50'000; ++i) {
    const BatteryParameters battery{.power_w_max = 1e3 + 1e7 * random.uniform(),
                                    .capacity_wh = 1e3 + 1e7 * random.uniform(),
                                    .charge_efficiency = 0.5 + 0.5 * random.uniform(),
                                    .discharge_efficiency = 0.5 + 0.5 * random.uniform(),
                                    .soc_min_frac = 0.4 * random.uniform(),
                                    .soc_max_frac = 0.6 + 0.4 * random.uniform()};
    const double soc =
        battery.soc_min_frac + random.uniform() * (battery.soc_max_frac - battery.soc_min_frac);
    const double wanted_w = 3 * battery.power_w_max * (random.uniform() - 0.5);
    const double hours = random.uniform() + 1e-3;
    const BatteryStep step = battery_step(battery, soc, wanted_w, hours);
    ASSERT_GE(step.soc_frac, battery.soc_min_frac - kRounding);
    ASSERT_LE(step.soc_frac, battery.soc_max_frac + kRounding);
    ASSERT_LE(std::fabs(step.power_w), battery.power_w_max);
    ASSERT_LE(std::fabs(step.power_w), std::fabs(wanted_w));
    ASSERT_GE(step.power_w * wanted_w, 0);
    const double gained_wh = (step.soc_frac - soc) * battery.capacity_wh;
    ASSERT_NEAR(gained_wh, stored_wh(battery, step.power_w, hours), 1e-9 * battery.capacity_wh);
  }
}

BatteryParameters real_battery() {
  BatteryParameters battery;
  battery.charge_taper = {.width_frac = 0.1, .share = 0.2};
  battery.discharge_taper = {.width_frac = 0.05, .share = 0.5};
  battery.full_power_loss_frac = 0.03;
  return battery;
}

TEST(RealBattery, TapersInAStraightLineTowardsItsBound) {
  const BatteryParameters battery = real_battery();
  const auto power_w = [&](double soc_frac, double wanted_w) {
    return battery_step(battery, soc_frac, wanted_w, 1e-6).power_w;
  };
  EXPECT_EQ(power_w(0.89, 4e6), 4e6);
  EXPECT_NEAR(power_w(0.95, 4e6), 0.6 * 4e6, 1);
  EXPECT_NEAR(power_w(0.999, 4e6), 0.208 * 4e6, 1);
  EXPECT_EQ(power_w(0.95, 1e6), 1e6) << "less than the rest is allowed in full";
  EXPECT_NEAR(power_w(0.125, -4e6), -0.75 * 4e6, 1);
  EXPECT_EQ(power_w(0.95, -4e6), -4e6) << "each bound has its own direction";
}

TEST(RealBattery, LossesGrowWithTheSquareOfThePower) {
  BatteryParameters battery;
  battery.full_power_loss_frac = 0.04;
  for (const double wanted_w : {4e6, 1e6, -1e6, -4e6}) {
    const double stored = (battery_step(battery, 0.5, wanted_w, 0.01).soc_frac - 0.5) * 8e6;
    const double loss_wh = 0.04 * wanted_w * wanted_w / 4e6 * 0.01;
    EXPECT_NEAR(stored, stored_wh(battery, wanted_w, 0.01) - loss_wh, 1e-6) << wanted_w;
  }
}

TEST(RealBattery, ConservesEnergyAndStaysInside) {
  Random random(9);
  for (int i = 0; i < 50'000; ++i) {
    BatteryParameters battery = real_battery();
    battery.full_power_loss_frac = 0.3 * random.uniform();
    const double soc = 0.1 + 0.9 * random.uniform();
    const double wanted_w = 3 * battery.power_w_max * (random.uniform() - 0.5);
    const double hours = random.uniform() + 1e-3;
    const BatteryStep step = battery_step(battery, soc, wanted_w, hours);
    ASSERT_GE(step.soc_frac, 0.1 - 1e-12);
    ASSERT_LE(step.soc_frac, 1 + 1e-12);
    ASSERT_LE(std::fabs(step.power_w), std::fabs(wanted_w) * (1 + 1e-12));
    const double loss_wh = battery.full_power_loss_frac * step.power_w * step.power_w / 4e6 * hours;
    ASSERT_NEAR((step.soc_frac - soc) * 8e6, stored_wh(battery, step.power_w, hours) - loss_wh,
                1e-3);
  }
}

/// The same by small steps of time.
ResponsePower integrated(const PowerResponse& response, PowerState from, double wanted_w,
                         double seconds) {
  constexpr double kStepS = 1e-4;
  double ramp_w = from.ramped_w, lag_w = from.flowing_w, sum = 0;
  for (double t = 0; t < seconds - kStepS / 2; t += kStepS) {
    if (t >= response.delay_s) {
      const double reach_w = response.ramp_w_per_s > 0 ? response.ramp_w_per_s * kStepS : INFINITY;
      ramp_w = std::clamp(wanted_w, ramp_w - reach_w, ramp_w + reach_w);
      const double tau_s = response.time_constant_s;
      lag_w = tau_s > 0 ? lag_w + (ramp_w - lag_w) * kStepS / tau_s : ramp_w;
    }
    sum += lag_w * kStepS;
  }
  return {sum / seconds, {ramp_w, lag_w}};
}

TEST(PowerResponse, MeanAndEndAreThoseOfTheCourse) {
  for (const double delay_s : {0.0, 2.0}) {
    for (const double ramp_w_per_s : {0.0, 50.0, 400.0}) {
      for (const double tau_s : {0.0, 3.0, 30.0}) {
        const PowerResponse response{delay_s, ramp_w_per_s, tau_s};
        PowerState from{-4'000, -4'000};
        for (const double wanted_w :
             {3'000.0, 3'000.0, -500.0}) {  // from the state that each has reached
          const ResponsePower exact = integrated(response, from, wanted_w, 30);
          const ResponsePower closed = response_power(response, from, wanted_w, 30);
          SCOPED_TRACE(testing::Message() << delay_s << ' ' << ramp_w_per_s << ' ' << tau_s);
          EXPECT_NEAR(closed.mean_w, exact.mean_w, 2);
          EXPECT_NEAR(closed.end.ramped_w, exact.end.ramped_w, 2);
          EXPECT_NEAR(closed.end.flowing_w, exact.end.flowing_w, 2);
          from = exact.end;
          if (tau_s == 0) from.flowing_w = from.ramped_w;
        }
      }
    }
  }
}

TEST(PowerResponse, NothingHappensWithinTheDelayOrWithoutAStep) {
  const PowerState at{100, 90};
  EXPECT_EQ(response_power({.delay_s = 5}, at, 900, 4).mean_w, 90);
  EXPECT_EQ(response_power({.delay_s = 5}, at, 900, 4).end.ramped_w, 100);
  EXPECT_EQ(response_power({.time_constant_s = 5}, {700, 700}, 700, 60).mean_w, 700);
  EXPECT_FALSE(PowerResponse{}.exists());
}

}  // namespace
}  // namespace bess
