// Following an order: every fault is found in two readings, and a slow or noisy battery, or one
// near an end of its charge, is accepted.
#include "edge/core/supervision/response_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/driven_reading.h"

namespace bess {
namespace {

constexpr std::int32_t kStepS = 120;

/// A battery of 4 kW and 8 kWh that is read every two minutes, with its displayed values.
struct MonitoredSite {
  ResponseMonitor monitor{ResponseSettings{}};
  double soc_frac = 0.5;
  std::int64_t utc_s = 0;
  std::int32_t soc_floor_e4 = 1'000;
  BatteryMeasurement shown{.soc_e4 = 5'000, .capacity_wh = 8'000};

  /// An order is followed for one step; then it is read, changed by `fault`.
  void step(
      std::int32_t ordered_w, double flowing_w,
      const std::function<void(BatteryMeasurement&)>& fault = [](BatteryMeasurement&) {}) {
    soc_frac = std::clamp(soc_frac + flowing_w * kStepS / 3'600.0 / 8'000, 0.0, 1.0);
    utc_s += kStepS;
    shown.soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * 1e3)) * 10;
    shown.power_w = static_cast<std::int32_t>(std::lround(flowing_w));
    Response now = driven_reading(utc_s, ordered_w, 0);
    now.soc_floor_e4 = soc_floor_e4;
    now.measurement = shown;
    fault(now.measurement);
    monitor.observe(now);
  }
};

TEST(ResponseMonitor, EveryFaultIsFoundInTwoReadings) {
  struct Case {
    std::int32_t ordered_w, flowing_w;
    bool rests_between;
    Reason reason;
  };
  for (const Case& c : {Case{4'000, -4'000, false, Reason::kWrongDirection},
                        Case{-4'000, 4'000, false, Reason::kWrongDirection},
                        Case{0, -3'000, false, Reason::kUncontrolledPower},
                        Case{4'000, 8'000, true, Reason::kUncontrolledPower}}) {
    MonitoredSite site;
    site.step(c.ordered_w, c.flowing_w);
    if (c.rests_between) site.step(0, 0);
    EXPECT_EQ(site.monitor.trip(), std::nullopt) << c.ordered_w;
    site.step(c.ordered_w, c.flowing_w);
    EXPECT_EQ(site.monitor.trip(), c.reason) << c.ordered_w;
  }
}

TEST(ResponseMonitor, IdleBetweenDoesNotForgetTheWrongDirection) {
  MonitoredSite site;
  site.step(4'000, -4'000);
  for (int i = 0; i < 5; ++i) site.step(0, 0);
  EXPECT_EQ(site.monitor.trip(), std::nullopt);
  site.step(4'000, -4'000);
  EXPECT_EQ(site.monitor.trip(), Reason::kWrongDirection);
}

TEST(ResponseMonitor, ThreeRightAnswersForgetAWrongOne) {
  MonitoredSite site;
  for (int i = 0; i < 8; ++i) {
    const std::int32_t ordered_w = i / 4 % 2 == 0 ? 4'000 : -4'000;
    site.step(ordered_w, -ordered_w);
    for (int good = 0; good < 3; ++good) site.step(ordered_w, ordered_w);
    EXPECT_EQ(site.monitor.trip(), std::nullopt) << i;
  }
}

/// Restored or after a pause, with an unknown previous order: the power may still be changing.
TEST(ResponseMonitor, TheFirstReadingOfANewOrderMayBeARamp) {
  const auto after_first_readings = [](std::int32_t ordered_w, std::int32_t power_w,
                                       std::int32_t age_s) {
    ResponseMonitor monitor{ResponseSettings{}};
    for (int i = 0; i < 4; ++i) {  // far apart: none knows the previous one
      monitor.observe(driven_reading(3'600 * (i + 1), ordered_w, power_w, age_s, 5'000 + i, 0));
    }
    return monitor.trip();
  };
  EXPECT_EQ(after_first_readings(0, -490, 117), std::nullopt);
  EXPECT_EQ(after_first_readings(-1'000, 490, 117), std::nullopt);
  EXPECT_EQ(after_first_readings(1'000, 1'350, 117), std::nullopt);
  // It has lasted longer, or no ramp of any battery would be that far behind.
  EXPECT_EQ(after_first_readings(0, -490, 237), Reason::kUncontrolledPower);
  EXPECT_EQ(after_first_readings(0, -3'000, 117), Reason::kUncontrolledPower);
  EXPECT_EQ(after_first_readings(4'000, -4'000, 117), Reason::kWrongDirection);
  EXPECT_EQ(after_first_readings(4'000, 8'000, 117), Reason::kUncontrolledPower);
  EXPECT_EQ(after_first_readings(-1'000, 1'900, 117), Reason::kWrongDirection);
}

TEST(ResponseMonitor, LessThanOrderedIsReportedWithoutAStop) {
  MonitoredSite site;
  for (int i = 0; i < 8; ++i) site.step(4'000, 1'200);
  EXPECT_EQ(site.monitor.trip(), std::nullopt);
  EXPECT_FALSE(site.monitor.gives_no_answer());
  EXPECT_EQ(site.monitor.weak_answers(), 8);
  site.step(4'000, 3'900);
  EXPECT_EQ(site.monitor.weak_answers(), 0);
}

TEST(ResponseMonitor, NoPowerInTheMiddleOfTheChargeIsNoAnswer) {
  MonitoredSite site;
  site.step(4'000, 0);
  EXPECT_FALSE(site.monitor.gives_no_answer());
  site.step(-4'000, 0);
  EXPECT_TRUE(site.monitor.gives_no_answer());
  EXPECT_EQ(site.monitor.trip(), std::nullopt);
}

/// The noise is 200 W: up to twice that, 0 W is no evidence.
TEST(ResponseMonitor, NoPowerProvesNothingUpToTwiceTheNoise) {
  for (const std::int32_t ordered_w : {300, 400, 410}) {
    MonitoredSite site;
    for (int i = 0; i < 2; ++i) site.step(ordered_w, 0);
    EXPECT_EQ(site.monitor.gives_no_answer(), ordered_w > 400) << ordered_w;
    EXPECT_EQ(site.monitor.weak_answers(), ordered_w > 400 ? 2 : 0) << ordered_w;
  }
}

/// README: an order of 0 W restarts the count.
TEST(ResponseMonitor, UnansweredOrdersAreCountedInARow) {
  MonitoredSite site;
  site.soc_frac = 0.97;
  for (int i = 0; i < 4; ++i) site.step(4'000, 0);
  EXPECT_EQ(site.monitor.unanswered_orders(), 4);
  site.step(0, 0);
  EXPECT_EQ(site.monitor.unanswered_orders(), 0);
  site.step(4'000, 0);
  EXPECT_EQ(site.monitor.unanswered_orders(), 1);
}

TEST(ResponseMonitor, AFullEmptyColdOrLimitedBatteryMayRest) {
  struct Case {
    const char* name;
    double soc_frac;
    std::int32_t ordered_w;
    std::function<void(BatteryMeasurement&)> fault;
    std::int32_t soc_floor_e4 = 1'000;
  };
  const auto nothing = [](BatteryMeasurement&) {};
  for (const Case& c : {
           Case{"full", 0.97, 4'000, nothing},
           Case{"empty", 0.12, -4'000, nothing},
           Case{"at its reserve", 0.505, -4'000, nothing, 5'000},
           Case{"cold", 0.5, 4'000, [](BatteryMeasurement& m) { m.temperature_min_deci_c = 20; }},
           Case{"limited", 0.5, 4'000, [](BatteryMeasurement& m) { m.charge_w_max = 0; }},
           Case{"limited", 0.5, -4'000, [](BatteryMeasurement& m) { m.discharge_w_max = 100; }},
       }) {
    MonitoredSite site;
    site.soc_frac = c.soc_frac;
    site.soc_floor_e4 = c.soc_floor_e4;
    for (int i = 0; i < 10; ++i) site.step(c.ordered_w, 0, c.fault);
    EXPECT_FALSE(site.monitor.gives_no_answer()) << c.name;
    EXPECT_EQ(site.monitor.weak_answers(), 0) << c.name;
    EXPECT_EQ(site.monitor.unanswered_orders(), 10) << c.name;
  }
}

TEST(ResponseMonitor, LimitsThatAllowNothingAreCounted) {
  MonitoredSite site;
  const auto locked = [](BatteryMeasurement& m) { m.charge_w_max = m.discharge_w_max = 0; };
  for (int i = 0; i < 40; ++i) site.step(0, 0, locked);
  EXPECT_EQ(site.monitor.findings().locked_readings, 40);
  site.step(0, 0, [](BatteryMeasurement& m) { m.charge_w_max = 0; });
  EXPECT_EQ(site.monitor.findings().locked_readings, 0);
}

TEST(ResponseMonitor, ASlowRampIsReportedAndNoFault) {
  ResponseMonitor monitor{ResponseSettings{}};
  double power_w = 0;
  for (int i = 0; i < 40; ++i) {
    const std::int32_t ordered_w = i / 2 % 2 == 0 ? 4'000 : -4'000;
    power_w += std::clamp(ordered_w - power_w, -3'300.0, 3'300.0);  // 30 W/s, read before its end
    monitor.observe(driven_reading(kStepS * (i + 1), ordered_w, static_cast<std::int32_t>(power_w),
                                   kStepS - 5, 5'000 + i % 2 * 10, 80'000));
  }
  EXPECT_EQ(monitor.trip(), std::nullopt);
  EXPECT_NEAR(monitor.findings().ramp_w_per_s, 29, 2);
}

/// A time constant of 60 s: 8 kW move by 59 W/s, and 2 kW by 15, which is no ramp of 15.
TEST(ResponseMonitor, ALagIsNotTakenForTheRampOfItsSmallestStep) {
  ResponseMonitor monitor{ResponseSettings{}};
  double power_w = -4'000;
  for (int i = 0; i < 6; ++i) {
    const std::int32_t size_w = i < 3 ? 4'000 : 1'000;
    const std::int32_t ordered_w = i % 2 == 0 ? size_w : -size_w;
    power_w = ordered_w + (power_w - ordered_w) * std::exp(-(kStepS - 5) / 60.0);
    monitor.observe(driven_reading(kStepS * (i + 1), ordered_w, static_cast<std::int32_t>(power_w),
                                   kStepS - 5, 5'000 + i % 2 * 10, 80'000));
  }
  EXPECT_EQ(monitor.trip(), std::nullopt);
  EXPECT_GE(monitor.findings().ramp_w_per_s, 50);
}

TEST(ResponseMonitor, ABatteryThatLooksAfterItselfIsNoFault) {
  for (const auto& [soc_e4, power_w] : {std::pair{800, 2'000}, {1'100, 500}, {9'800, 450}}) {
    ResponseMonitor monitor{ResponseSettings{}};
    for (int i = 0; i < 2; ++i) {
      EXPECT_FALSE(monitor.looks_after_itself());
      monitor.observe(driven_reading(120 * i, 0, power_w, 117, soc_e4));
    }
    EXPECT_TRUE(monitor.looks_after_itself()) << soc_e4;
    EXPECT_EQ(monitor.trip(), std::nullopt) << soc_e4;
  }
}

/// Full power for the first half of every step, none for the second, as a meter's limit causes.
TEST(ResponseMonitor, AnOrderThatIsCutWithinItsStepHasMovedWhatItMoved) {
  ResponseMonitor monitor{ResponseSettings{}};
  double soc_frac = 0.2;
  for (int i = 0; i < 10; ++i) {
    Response now = driven_reading(i * kStepS + kStepS / 2, 4'000, 4'000, kStepS / 2);
    soc_frac += 4'000 * kStepS / 2 / 3'600.0 / 8'000;
    now.measurement.soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * 1e4));
    monitor.note_power(now);
    now.measurement.power_w = now.ordered_power_w = 0;
    now.steady_s += kStepS / 2;
    monitor.observe(now);
    EXPECT_EQ(monitor.trip(), std::nullopt) << i;
    EXPECT_FALSE(monitor.has_jumped()) << i;
  }
}

TEST(ResponseMonitor, ASocThatJumpsStopsUntilItAgreesAgain) {
  MonitoredSite site;
  site.step(4'000, 4'000);
  site.step(4'000, 4'000, [](BatteryMeasurement& m) { m.soc_e4 -= 4'000; });
  EXPECT_TRUE(site.monitor.has_jumped());
  site.step(0, 0);  // and back
  EXPECT_TRUE(site.monitor.has_jumped());
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(site.monitor.has_jumped());
    site.step(0, 0);
  }
  EXPECT_FALSE(site.monitor.has_jumped());
  EXPECT_EQ(site.monitor.trip(), std::nullopt);
}

TEST(ResponseMonitor, AnOrderThatIsTooYoungIsNotJudged) {
  ResponseMonitor monitor{ResponseSettings{}};
  for (int i = 0; i < 10; ++i) {
    const std::int32_t ordered_w = i % 2 == 0 ? 4'000 : -4'000;
    monitor.observe(driven_reading(120 * i, ordered_w, 0, ResponseBand{}.settle_s - 1));
  }
  EXPECT_FALSE(monitor.gives_no_answer());
  EXPECT_EQ(monitor.trip(), std::nullopt);
}

TEST(ResponseMonitor, ItsOwnModeIsNotJudged) {
  ResponseMonitor monitor{ResponseSettings{}};
  for (int i = 0; i < 10; ++i) {
    Response now = driven_reading(120 * i, 4'000, -3'000);
    now.is_driven = false;
    monitor.observe(now);
  }
  EXPECT_EQ(monitor.trip(), std::nullopt);
}

TEST(ResponseMonitor, SurplusSunMayChargeWhereTheMapSaysSo) {
  ResponseSettings settings;
  settings.band.charges_by_itself = true;
  ResponseMonitor monitor{settings};
  for (int i = 0; i < 12; ++i) {
    const std::int32_t ordered_w = i < 4 ? 0 : i < 8 ? -1'000 : 1'000;
    monitor.observe(driven_reading(120 * i, ordered_w, 2'500, 120, 5'000 + 100 * i));
  }
  EXPECT_EQ(monitor.trip(), std::nullopt);
}

TEST(ResponseMonitor, DischargingAgainstAnOrderToChargeIsTheWrongDirectionThereToo) {
  ResponseSettings settings;
  settings.band.charges_by_itself = true;
  MonitoredSite site{ResponseMonitor{settings}};
  for (int i = 0; i < 2; ++i) site.step(4'000, -4'000);
  EXPECT_EQ(site.monitor.trip(), Reason::kWrongDirection);
}

/// Control cycles under clock steps: readings seconds after their order, and soon again.
struct ShortCycles {
  ResponseMonitor monitor{ResponseSettings{}};
  std::int64_t steady_s = 0;

  void read(std::int32_t ordered_w, std::int32_t age_s, std::int32_t power_w,
            std::int64_t after_s = kStepS, std::int32_t soc_e4 = 5'000) {
    monitor.observe(driven_reading(steady_s += after_s, ordered_w, power_w, age_s, soc_e4));
  }
};

TEST(ResponseMonitor, SomeSecondsBeyondItsMapThePreviousOrderIsNoFault) {
  ShortCycles cycles;
  cycles.read(4'000, 117, 4'000, kStepS, 5'000);
  cycles.read(0, 22, 4'000, 25, 5'030);  // of a lag of 25 s, where the map has 20
  cycles.read(0, 117, 0, 95, 5'030);
  cycles.read(4'000, 117, 4'000, kStepS, 5'160);
  cycles.read(0, 22, 4'000, 25, 5'190);
  EXPECT_EQ(cycles.monitor.trip(), std::nullopt);
  for (int i = 0; i < 2; ++i) cycles.read(0, 31, 4'000, 31, 5'220 + 30 * i);
  EXPECT_EQ(cycles.monitor.trip(), Reason::kUncontrolledPower) << "after that it is one";
}

TEST(ResponseMonitor, AnOrderThatIsReadTwiceOnItsWayIsOnItsWay) {
  ShortCycles cycles;
  cycles.read(4'000, 117, 4'000);
  cycles.read(0, 40, 2'900, 40);
  cycles.read(0, 80, 1'800, 40);
  cycles.read(0, 117, 800, 37);
  EXPECT_EQ(cycles.monitor.trip(), std::nullopt);
  for (int i = 0; i < 2; ++i) cycles.read(0, 150 + i, 800, 33);
  EXPECT_EQ(cycles.monitor.trip(), Reason::kUncontrolledPower) << "constant is no transition";
}

/// 30 W/s, read at -2488 W and ordered back a minute later, when it had got to -4000 W.
TEST(ResponseMonitor, ATransitionContinuesUntilTheNextOrder) {
  for (const bool is_on_its_way : {true, false}) {
    ShortCycles cycles;
    for (int i = 0; i < 4; ++i) {
      const std::int32_t soc_e4 = 7'000 - 190 * i;
      cycles.read(0, 117, 0, kStepS, soc_e4);
      cycles.read(-4'000, is_on_its_way ? 89 : 300, -2'488, is_on_its_way ? 92 : 310, soc_e4 - 60);
      cycles.read(0, 117, -630, 178, soc_e4 - 190);
    }
    EXPECT_EQ(cycles.monitor.trip().has_value(), !is_on_its_way);
  }
}

/// 30 W/s behind a lag of 9 s.
TEST(ResponseMonitor, ALagCountsInAShortCycle) {
  for (const std::int32_t power_w : {2'892, 3'225}) {
    ShortCycles cycles;
    for (int i = 0; i < 3; ++i) {
      cycles.read(4'000, 117, 3'425, kStepS, 5'000 + 150 * i);
      cycles.read(0, 30, power_w, 33, 5'040 + 150 * i);
    }
    EXPECT_EQ(cycles.monitor.trip().has_value(), power_w >= 3'000);
  }
}

/// Near full 1.6 of 4 kW flow: on the way to 0 W the set point is still above that at first.
TEST(ResponseMonitor, ARampComesFromTheOrderThatWasHeldBack) {
  for (const std::int32_t soc_e4 : {9'700, 5'000}) {
    ShortCycles cycles;
    cycles.read(4'000, 370, 1'629, kStepS, soc_e4);
    for (int i = 0; i < 2; ++i) cycles.read(0, 107, 942 - i, 107, soc_e4);
    const bool is_near_full = soc_e4 == 9'700;
    EXPECT_EQ(cycles.monitor.trip().has_value(), !is_near_full) << soc_e4;
  }
}

}  // namespace
}  // namespace bess
