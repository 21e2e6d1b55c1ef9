// Meter check, reading by reading: doubts, findings, and how they end. Whole days with moving
// houses are in tests/system/closed_loop/meter_liars_test.cpp.
#include "edge/core/site/meter_check.h"

#include <gtest/gtest.h>

#include <functional>

#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr std::int64_t kStart = 1'679'788'800;

/// A controller's schedule of readings, without the controller: orders, steady readings, cuts.
struct Connection {
  /// The meter's value from house and battery.
  std::function<double(double)> meter = [](double grid_w) { return grid_w; };
  MeterCheck meter_check{MeterCheckSettings{}};
  std::int64_t utc_s = kStart;
  std::int64_t ordered_utc_s = kStart - 3'600;
  std::int32_t power_w = 0;
  std::int32_t house_w = 400;
  bool is_driven = true;

  void read() {
    meter_check.observe({.utc_s = utc_s,
                         .grid_w = static_cast<std::int32_t>(meter(house_w + power_w)),
                         .battery_w = power_w,
                         .order = {.is_driven = is_driven,
                                   .age_s = static_cast<std::int32_t>(utc_s - ordered_utc_s)}});
    ask_again();
  }
  /// As in the loop: the allowed power has decreased.
  void ask_again() {
    const std::int32_t most_w = meter_check.power_w_max(utc_s);
    if (power_w > most_w || power_w < -most_w) order(power_w > 0 ? most_w : -most_w);
  }
  void order(std::int32_t watts) {
    if (watts != power_w) ordered_utc_s = utc_s;
    power_w = watts;
  }
  /// One control cycle at that requested power, from the tick on; readings every 10 s.
  void cycle(std::int32_t requested_w) {
    const std::int32_t most_w = meter_check.power_w_max(utc_s);
    order(std::max(-most_w, std::min(most_w, requested_w)));
    for (int i = 0; i < 12; ++i) {
      utc_s += i == 0 ? 7 : 10;
      read();
    }
    utc_s += 3;
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) cycle(i % 3 == 0 ? 4'000 : i % 3 == 1 ? 0 : -4'000);
  }
};

TEST(MeterCheck, OneContradictionIsWithdrawnImmediatelyAndForgiven) {
  Connection c;
  c.cycles(6);
  c.order(4'000);
  c.utc_s += 27;
  c.house_w = -3'600;  // a load switched off at that moment
  c.read();
  EXPECT_EQ(c.power_w, 0);
  EXPECT_EQ(c.meter_check.trust().doubt, 3);
  EXPECT_FALSE(c.meter_check.is_mismatch());
  c.utc_s += 93;  // the tick
  EXPECT_EQ(c.meter_check.power_w_max(c.utc_s), kAnyPowerW);
  c.cycles(6);
  EXPECT_EQ(c.meter_check.trust().doubt, 0);
}

/// Time constant 600 s: a change of 3 kW excuses a step of 4 kW, and after three of them 150 W do
/// not.
TEST(MeterCheck, AHouseThatHasBecomeQuietExcusesNothing) {
  for (const int quiet_cycles : {0, 15}) {
    Connection c;
    for (int i = 0; i < 4; ++i) {
      c.house_w = i % 2 == 0 ? 3'400 : 400;
      c.read();
      c.utc_s += 30;
    }
    for (int i = 0; i < quiet_cycles; ++i) c.cycle(0);
    c.order(4'000);
    c.utc_s += 27;
    c.house_w -= 4'000;
    c.read();
    EXPECT_EQ(c.meter_check.trust().doubt, quiet_cycles == 0 ? 0 : 3) << quiet_cycles;
  }
}

/// An inverted meter shows the step with the other sign; half as much again, and twice the error
/// of 100 W, is no meter.
TEST(MeterCheck, AStepThatIsFarMoreThanInvertedIsTheHouse) {
  for (const std::int32_t along_w : {-4'000, -6'200, -6'201, -8'000}) {
    Connection c;
    c.read();
    c.order(4'000);
    c.utc_s += 27;
    c.house_w += along_w - 4'000;
    c.read();
    EXPECT_EQ(c.meter_check.trust().doubt, along_w < -6'200 ? 0 : 3) << along_w;
  }
}

TEST(MeterCheck, ARatioNearOneIsFoundByItsSums) {
  for (const double ratio : {0.65, 1.5}) {
    Connection c;
    c.meter = [ratio](double w) { return ratio * w; };
    c.cycles(20);
    EXPECT_TRUE(c.meter_check.is_mismatch()) << ratio;
  }
  Connection near;
  near.meter = [](double w) { return 0.85 * w; };  // two meters of a house differ
  near.cycles(200);
  EXPECT_FALSE(near.meter_check.is_mismatch());
  EXPECT_EQ(near.meter_check.trust().doubt, 0);
}

TEST(MeterCheck, ARatioThatAStepHasShownIsPossibleFromThenOn) {
  Connection c;
  c.cycles(6);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).least_permille, 1'000);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).most_permille, 1'000);
  c.meter = [](double w) { return 0.65 * w; };
  c.cycle(4'000);  // from a correct reading to a wrong one
  c.cycle(0);
  EXPECT_NEAR(c.meter_check.possible_ratios(c.utc_s).least_permille, 650, 10);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).most_permille, 1'000);
  EXPECT_EQ(c.meter_check.trust().doubt, 0) << "and no doubt";
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s + 1'300).least_permille, 1'000)
      << "not permanent";
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s - 86'400).least_permille, 1'000)
      << "clock set back";
  c.meter = [](double w) { return w; };
  c.cycle(4'000);
  c.cycle(0);
  EXPECT_NEAR(c.meter_check.possible_ratios(c.utc_s).least_permille, 650, 10) << "of three steps";
  c.cycle(4'000);
  c.cycle(0);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).least_permille, 1'000);
  c.meter = [](double w) { return 3 * w; };
  c.cycle(0);
  c.cycle(900);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).most_permille, 2'000) << "no further";
}

TEST(MeterCheck, AContradictionIsNoRatio) {
  Connection c;
  c.cycles(6);
  c.meter = [](double w) { return -w; };
  c.cycles(2);
  EXPECT_EQ(c.meter_check.possible_ratios(c.utc_s).least_permille, 1'000);
}

TEST(MeterCheck, AFindingIsTestedAfterItsPauseAndEnds) {
  Connection c;
  c.meter = [](double w) { return -w; };
  c.cycles(4);
  ASSERT_TRUE(c.meter_check.is_mismatch());
  c.meter = [](double w) { return w; };
  const std::int64_t pause_until_utc_s = c.meter_check.trust().pause_until_utc_s;
  std::int32_t largest_w = 0;
  int cycles = 0;
  while (c.meter_check.is_mismatch() && ++cycles < 100) {
    c.cycle(4'000);
    largest_w =
        std::max(largest_w, c.meter_check.is_mismatch() ? c.meter_check.power_w_max(c.utc_s) : 0);
    const bool is_paused = c.utc_s < pause_until_utc_s;
    EXPECT_TRUE(!is_paused || c.power_w == 0);
  }
  EXPECT_LT(cycles, 20);
  EXPECT_EQ(largest_w, 500);
  EXPECT_EQ(c.meter_check.power_w_max(c.utc_s), kAnyPowerW);
}

TEST(MeterCheck, OneThatStaysWrongIsPausedForLongerEachTime) {
  Connection c;
  c.meter = [](double w) { return -w; };
  c.cycles(4);
  std::int32_t pause_s = 600;
  int cycles_driven = 0;
  for (int i = 0; i < 3 * kStepsPerDay; ++i) {
    c.cycle(4'000);
    EXPECT_TRUE(c.meter_check.is_mismatch());
    EXPECT_GE(c.meter_check.trust().pause_s, pause_s);
    pause_s = c.meter_check.trust().pause_s;
    cycles_driven += c.ordered_utc_s > c.utc_s - kSecondsPerStep;
  }
  EXPECT_EQ(pause_s, 6 * 3'600);
  EXPECT_LE(cycles_driven, 20);
}

TEST(MeterCheck, ARestartTakesTheFindingOver) {
  Connection before;
  before.meter = [](double) { return 400.0; };
  before.cycles(4);
  ASSERT_TRUE(before.meter_check.is_mismatch());
  Connection after;
  after.utc_s = before.utc_s;
  after.meter_check.restore(before.meter_check.trust());
  EXPECT_EQ(after.meter_check.power_w_max(after.utc_s), 0);
  Connection doubtful;
  doubtful.meter_check.restore({.doubt = 8});
  doubtful.meter = before.meter;
  doubtful.cycles(2);
  EXPECT_TRUE(doubtful.meter_check.is_mismatch());
}

TEST(MeterCheck, AClockThatWasSteppedBackMakesNoPauseLonger) {
  Connection c;
  c.meter = [](double) { return 400.0; };
  c.cycles(4);
  ASSERT_EQ(c.meter_check.power_w_max(c.utc_s), 0);
  EXPECT_EQ(c.meter_check.power_w_max((c.utc_s - 86'400) / 240 * 240 + 120), 500);
}

TEST(MeterCheck, NothingIsJudgedOfABatteryInItsOwnModeOrWithoutPower) {
  Connection c;
  c.meter = [](double) { return 400.0; };
  c.is_driven = false;
  c.cycles(30);
  EXPECT_EQ(c.meter_check.trust().doubt, 0);
  Connection at_rest;
  at_rest.meter = c.meter;
  for (int i = 0; i < 100; ++i) {
    at_rest.house_w = 400 + 3'000 * (i % 2);
    at_rest.cycle(0);
  }
  EXPECT_EQ(at_rest.meter_check.trust().doubt, 0);
}

TEST(MeterCheck, CanBeDisabled) {
  Connection c;
  c.meter_check = MeterCheck({.judges = false});
  c.meter = [](double) { return 400.0; };
  c.cycles(30);
  EXPECT_EQ(c.meter_check.power_w_max(c.utc_s), kAnyPowerW);
}

TEST(MeterCheck, AnyReadingIsSurvived) {
  Connection c;
  int i = 0;
  c.meter = [&i](double) {
    constexpr double kExtremes[] = {INT32_MIN, INT32_MAX, 0, -1};
    return kExtremes[i++ % 4];
  };
  c.cycles(100);
  EXPECT_GE(c.meter_check.trust().doubt, 0);
  EXPECT_LE(c.meter_check.trust().doubt, 10);
}

TEST(HouseWatch, AHouseGeneratesNoMoreThanItsPanels) {
  EXPECT_TRUE(is_plausible_house(500, 0, 0));
  EXPECT_TRUE(is_plausible_house(-200, 0, 0));
  EXPECT_FALSE(is_plausible_house(-631, 0, 0));
  EXPECT_FALSE(is_plausible_house(-131, 500, 0));
  EXPECT_TRUE(is_plausible_house(3'700, 4'000, 0));  // read a moment apart
  EXPECT_TRUE(is_plausible_house(-5'000, 0, 5'000));
  EXPECT_FALSE(is_plausible_house(-5'300, 0, 5'000));
  EXPECT_TRUE(is_plausible_house(INT32_MIN, INT32_MAX, kAnyPowerW));
  EXPECT_FALSE(is_plausible_house(INT32_MIN, INT32_MIN + 1, 0) &&
               is_plausible_house(INT32_MIN, INT32_MAX, 0));
}

TEST(HouseWatch, BeginsAndEndsWithSeveralReadings) {
  HouseWatch watch;
  for (int i = 0; i < 3; ++i) watch.observe(false);
  EXPECT_FALSE(watch.is_implausible());
  watch.observe(true);
  for (int i = 0; i < 4; ++i) watch.observe(false);
  EXPECT_TRUE(watch.is_implausible());
  for (int i = 0; i < 4; ++i) watch.observe(true);
  EXPECT_FALSE(watch.is_implausible());
}

}  // namespace
}  // namespace bess
