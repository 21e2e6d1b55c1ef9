// Log of a battery with known parameters, as its controller would have read it.
#include "workstation/data/env/battery_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "tests/support/temporary_folder.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

constexpr BatteryParameters kHouse{.power_w_max = 4'000, .capacity_wh = 8'000};

BatteryParameters real_battery() {
  BatteryParameters battery = kHouse;
  battery.charge_efficiency = 0.965;
  battery.discharge_efficiency = 0.955;
  battery.charge_taper = {.width_frac = 0.12, .share = 0.25};
  battery.discharge_taper = {.width_frac = 0.06, .share = 0.4};
  battery.full_power_loss_frac = 0.03;
  battery.standby_w = 35;
  return battery;
}

/// Whole watts and hundredths of a percent, as in its registers. Where it shows its limit in the
/// cold, its controller cuts the orders.
std::vector<LoggedCycle> log_of(const BatteryParameters& battery, int days, std::uint64_t seed,
                                bool says_limits = false) {
  constexpr int kPartsOfACycle = 24;
  Random random(seed);
  std::vector<LoggedCycle> cycles;
  double soc_frac = 0.5, power_w = 0, ordered_w = 0;
  for (int k = 0; k < days * kStepsPerDay; ++k) {
    const std::int64_t utc_s = std::int64_t{k} * kSecondsPerStep;
    cycles.push_back({utc_s, std::round(1e4 * soc_frac) / 1e4,
                      std::round(power_w + battery.standby_w + 4 * random.normal()), 0});
    if (random.uniform() < 0.03) {  // more than an hour each way, as with real prices
      const double share = random.uniform() < 0.7 ? 1 : 0.5;
      ordered_w = share * battery.power_w_max * (static_cast<int>(random.index(3)) - 1);
    }
    const double most_w = battery.power_w_at(local_minute_of(utc_s).quarter_hour);
    const double left_w = std::clamp(ordered_w, -most_w, most_w);
    cycles.back().is_cut = says_limits && left_w != ordered_w;
    cycles.back().ordered_w = says_limits ? left_w : ordered_w;
    for (int part = 0; part < kPartsOfACycle; ++part) {
      const BatteryStep step =
          battery_step(battery, soc_frac, left_w, kHoursPerStep / kPartsOfACycle);
      soc_frac = step.soc_frac;
      power_w = step.power_w;
    }
  }
  return cycles;
}

TEST(BatteryFit, FindsEachOfItsParametersWithinThreePercent) {
  const BatteryParameters real = real_battery();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const BatteryFit fit = fit_battery(log_of(real, 14, seed), kHouse);
    const auto expect = [&fit](const char* name, double truth) {
      ASSERT_TRUE(fit.contains(name)) << name;
      EXPECT_NEAR(fit.at(name).value, truth, 0.03 * truth) << name;
      EXPECT_GT(fit.at(name).standard_error, 0) << name;
      EXPECT_LT(fit.at(name).standard_error, 0.1 * truth) << name;
    };
    expect("charge_efficiency", 0.965);
    expect("discharge_efficiency", 0.955);
    expect("charge_taper_width", 0.12);
    expect("charge_taper_share", 0.25);
    expect("discharge_taper_width", 0.06);
    expect("discharge_taper_share", 0.4);
    expect("full_power_loss", 0.03);
    expect("standby_w", 35);
  }
}

TEST(BatteryFit, FindsTheColdHoursWhetherTheBatterySaysThemOrNot) {
  BatteryParameters real = real_battery();
  real.cold = {.power_share = 0.6, .from_hour = 22.5, .to_hour = 7};
  for (const bool says_limits : {false, true}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const BatteryFit fit = fit_battery(log_of(real, 14, seed, says_limits), kHouse);
      ASSERT_TRUE(fit.contains("cold_power_share"));
      EXPECT_NEAR(fit.at("cold_power_share").value, 0.6, 0.018);
      EXPECT_NEAR(fit.at("cold_from_hour").value, 22.5,
                  0.25 + fit.at("cold_from_hour").standard_error);
      EXPECT_NEAR(fit.at("cold_to_hour").value, 7, 0.25 + fit.at("cold_to_hour").standard_error);
      EXPECT_LE(fit.at("cold_to_hour").standard_error, 0.5);
      EXPECT_EQ(with_fit(kHouse, fit).cold.power_share, fit.at("cold_power_share").value);
      ASSERT_TRUE(fit.contains("charge_taper_share")) << "the limit in the cold is no taper";
      EXPECT_NEAR(fit.at("charge_taper_share").value, 0.25, 0.0125);
      EXPECT_NEAR(fit.at("discharge_taper_width").value, 0.06, 0.004);
    }
  }
}

TEST(BatteryFit, WhatABatteryDoesNotDoIsNotFound) {
  const BatteryFit fit = fit_battery(log_of(kHouse, 14, 4), kHouse);
  EXPECT_FALSE(fit.contains("charge_taper_width"));
  EXPECT_FALSE(fit.contains("discharge_taper_share"));
  EXPECT_FALSE(fit.contains("full_power_loss"));
  EXPECT_FALSE(fit.contains("standby_w"));
  EXPECT_FALSE(fit.contains("cold_power_share"));
  EXPECT_FALSE(fit_battery(log_of(real_battery(), 14, 4), kHouse).contains("cold_power_share"))
      << "tapers";
  ASSERT_TRUE(fit.contains("charge_efficiency"));
  EXPECT_NEAR(fit.at("charge_efficiency").value, kHouse.charge_efficiency, 0.003);
  EXPECT_NEAR(fit.at("discharge_efficiency").value, kHouse.discharge_efficiency, 0.003);
}

TEST(BatteryFit, AShortLogWithGapsShowsOnlyWhatItCan) {
  std::vector<LoggedCycle> cycles = log_of(real_battery(), 14, 5);
  Random random(6);
  std::erase_if(cycles, [&](const LoggedCycle&) { return random.uniform() < 0.2; });
  EXPECT_NEAR(fit_battery(cycles, kHouse).at("charge_taper_share").value, 0.25, 0.0125);
  cycles.resize(20);
  const BatteryFit little = fit_battery(cycles, kHouse);
  EXPECT_FALSE(little.contains("charge_efficiency"));
  EXPECT_FALSE(little.contains("charge_taper_width"));
}

TEST(BatteryFit, TheLogOfAnotherBatteryIsRefused) {
  const std::vector<LoggedCycle> cycles = log_of(real_battery(), 14, 7);
  BatteryParameters smaller = kHouse;
  smaller.power_w_max = 2'500;
  EXPECT_THROW(fit_battery(cycles, smaller), UserError);
  EXPECT_THROW(fit_battery(cycles, BatteryParameters{}), UserError) << "megawatts";
  BatteryParameters larger = kHouse;
  larger.capacity_wh = 16'000;  // cells that store twice their input
  EXPECT_THROW(fit_battery(cycles, larger), UserError);
}

TEST(BatteryFit, ALogIsReadByTheNamesOfItsColumns) {
  const TemporaryFolder folder;
  const std::string path = folder.file("log.csv");
  std::ofstream(path)
      << "utc,cycle,mode,soc_e4,battery_power_w,ordered_power_w,reason,battery_status,written,"
         "price_minute_utc,price_centi_eur_per_mwh,price_age_s,student_action,"
         "price_level_centi_q16,outlook,break_even_centi,price_stands_in,stand_in_centi\n"
         "2026-06-01T00:00:00Z,1,running,5000,12,4000,student,ok,1,none,0,-1,none,0,none,0,0,0\n"
         "2026-06-01T00:02:00Z,2,holding,0,0,0,link,timeout,0,none,0,-1,none,0,none,0,0,0\n"
         "2026-06-01T00:04:00Z,3,running,5100,4012,2400,power_limit,ok,1,none,0,-1,none,0,none,0,0,"
         "0\n";
  const std::vector<LoggedCycle> cycles = read_cycle_log({path}).cycles;
  ASSERT_EQ(cycles.size(), 3U);
  EXPECT_FALSE(cycles[1].has_reading);
  EXPECT_EQ(cycles[2].power_w, 4'012);
  EXPECT_EQ(cycles[0].ordered_w, 4'000);
  EXPECT_EQ(cycles[0].soc_frac, 0.5);
  EXPECT_FALSE(cycles[0].is_cut);
  EXPECT_TRUE(cycles[2].is_cut);
  std::ofstream(path) << "utc,cycle,soc_e4\n2026-06-01T00:00:00Z,1,5000\n";
  EXPECT_THROW(static_cast<void>(read_cycle_log({path})), UserError);
}

}  // namespace
}  // namespace bess
