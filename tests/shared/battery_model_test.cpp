// One step of the battery: energy is conserved, bounds are exact, and what does not fit is neither
// exchanged nor paid.
#include "shared/battery_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/units_and_limits.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

const double kEta = std::sqrt(0.9);

/// What the store gains for the energy exchanged with the grid [Paper, Eq. 2].
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

TEST(BatteryModel, RoundTripLosesWhatTheEfficiencySays) {
  const BatteryParameters battery;
  double soc = battery.soc_min_frac;
  double bought_wh = 0;
  double sold_wh = 0;
  for (int i = 0; i < 100; ++i) {
    const BatteryStep step = battery_step(battery, soc, 4e6, kHoursPerStep);
    bought_wh += step.power_w * kHoursPerStep;
    soc = step.soc_frac;
  }
  ASSERT_EQ(soc, battery.soc_max_frac);
  for (int i = 0; i < 100; ++i) {
    const BatteryStep step = battery_step(battery, soc, -4e6, kHoursPerStep);
    sold_wh -= step.power_w * kHoursPerStep;
    soc = step.soc_frac;
  }
  ASSERT_EQ(soc, battery.soc_min_frac);
  EXPECT_NEAR(sold_wh / bought_wh, 0.9, 1e-12);
}

}  // namespace
}  // namespace bess
