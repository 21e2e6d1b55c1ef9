// Wrong energy, against or beyond orders: it adds up over hours, decays over days, and survives
// pauses and restarts; only a manual clear resets it.
#include "edge/core/supervision/energy_balance.h"

#include <gtest/gtest.h>

#include "edge/core/loop/cycle_parts.h"
#include "tests/support/driven_reading.h"

namespace bess {
namespace {

constexpr std::int64_t kCapacityWh = 8'000;

/// 4 kW for two minutes of 8 kWh are 1.6667 %, of which 2.5 % / 720 are forgiven.
TEST(WrongEnergy, IsASumOfSharesOfTheCapacity) {
  WrongEnergy sum;
  sum.add(driven_reading(120, 4'000, 4'000), 0, kCapacityWh);
  sum.add(driven_reading(240, 4'000, -4'000), 4'000, kCapacityWh);
  EXPECT_NEAR(sum.share_e6(), 16'667 - 35, 1);
  for (int i = 0; i < 240; ++i) sum.add(driven_reading(360 + 120 * i, 0, 0), 0, kCapacityWh);
  EXPECT_NEAR(sum.share_e6(), 16'667 - 241 * 34.72, 3);
  sum.add(driven_reading(360 + 86'400, 0, 0), 0, kCapacityWh);
  EXPECT_EQ(sum.share_e6(), 0);
}

TEST(WrongEnergy, IsOfTheOrderAndOfKnownTimeOnly) {
  WrongEnergy young;
  young.add(driven_reading(120, 0, 0), 0, kCapacityWh);
  Response now = driven_reading(240, 4'000, -4'000);
  now.order_age_s = 30;
  young.add(now, 4'000, kCapacityWh);
  EXPECT_NEAR(young.share_e6(), 16'667 / 4 - 35, 1);
  WrongEnergy long_ago;
  long_ago.add(driven_reading(120, 0, 0), 0, kCapacityWh);
  now = driven_reading(7'320, 4'000, -4'000);
  now.order_age_s = 7'200;
  long_ago.add(now, 4'000, kCapacityWh);
  EXPECT_NEAR(long_ago.share_e6(), 16'667 * 5 / 2 - 2'083, 3);
}

TEST(WrongEnergy, WhateverADeviceSaysIsWithinItsBounds) {
  WrongEnergy sum;
  for (int i = 1; i < 10; ++i) sum.add(driven_reading(i * 300, 0, 0), std::int64_t{1} << 31, 1);
  EXPECT_TRUE(sum.is_found());
  EXPECT_LE(sum.share_e6(), 2 * WrongEnergy::kFoundE6);
  for (const std::int32_t logged : {INT32_MIN, INT32_MAX}) {
    sum.restore(logged);
    EXPECT_GE(sum.share_e6(), 0);
    EXPECT_LE(sum.share_e6(), 2 * WrongEnergy::kFoundE6);
  }
}

/// The SoC of a battery without losses.
struct Cells {
  double soc_e4 = 5'000;

  void move(Response& now, double seconds) {
    soc_e4 += now.measurement.power_w * seconds / 3'600 / kCapacityWh * 10'000;
    now.measurement.soc_e4 = static_cast<std::int32_t>(soc_e4);
  }
};

/// At every fifth reading, which the counters forgive.
struct RarelyWrong {
  Supervision supervision{SupervisionSettings{}};
  Cells cells;
  std::int64_t steady_s = 0;
  int wrong = 0;

  void run(std::int32_t ordered_w, std::int32_t wrong_w, int readings) {
    for (int i = 0; i < readings && !supervision.trip(); ++i) {
      const bool is_wrong = i % 5 == 4;
      wrong += is_wrong ? 1 : 0;
      Response now = driven_reading(steady_s += 120, ordered_w, is_wrong ? wrong_w : ordered_w);
      cells.move(now, 120);
      supervision.observe(now, false);
    }
  }
  [[nodiscard]] std::int32_t share_e6() const {
    return supervision.response().findings().wrong_energy_e6;
  }
};

TEST(WrongEnergy, TripsAsWhatItIsAtAFifthOfTheCapacity) {
  struct Case {
    std::int32_t ordered_w, wrong_w, from_e4;
    Reason reason;
    int wrong;
  };
  for (const Case& c : {Case{4'000, -4'000, 1'500, Reason::kWrongDirection, 13},
                        Case{-4'000, 4'000, 8'500, Reason::kWrongDirection, 13},
                        Case{2'000, 6'000, 1'000, Reason::kUncontrolledPower, 13},
                        Case{0, -2'000, 7'000, Reason::kUncontrolledPower, 25}}) {
    RarelyWrong rare;
    rare.cells.soc_e4 = c.from_e4;
    rare.run(c.ordered_w, c.wrong_w, 200);
    EXPECT_EQ(rare.supervision.trip()->reason, c.reason) << c.ordered_w;
    EXPECT_NEAR(rare.wrong, c.wrong, 1) << c.ordered_w;
  }
}

TEST(WrongEnergy, APauseForgetsNoneOfIt) {
  RarelyWrong rare;
  rare.run(4'000, -4'000, 20);
  const std::int32_t before_e6 = rare.share_e6();
  ASSERT_GT(before_e6, WrongEnergy::kReportedE6);
  for (int i = 0; i < 3; ++i) rare.supervision.on_ordered(rare.steady_s, Status::kBadReply);
  ASSERT_EQ(rare.supervision.stop_reason(), Reason::kOrdersFail);
  EXPECT_EQ(rare.share_e6(), before_e6);
  rare.supervision.clear();
  EXPECT_EQ(rare.share_e6(), 0);
}

TEST(WrongEnergy, ARestartKeepsItAndAClearedTripDoesNot) {
  CycleRecord before;
  before.findings.wrong_energy_e6 = 190'000;
  CycleRecord after;
  SupervisionPart kept(SupervisionSettings{}, 10);
  kept.take_over(before, std::nullopt);
  kept.report(after);
  EXPECT_EQ(after.findings.wrong_energy_e6, 190'000);
  before.is_tripped = true;
  SupervisionPart cleared(SupervisionSettings{}, 10);
  cleared.take_over(before, std::nullopt);
  cleared.report(after);
  EXPECT_EQ(after.findings.wrong_energy_e6, 0);
}

/// A battery at a site with a meter, which is also checked between the ticks; 40 minutes each way.
struct WatchedSite {
  SupervisionPart part{SupervisionSettings{}, 10};
  Cells cells;
  CycleRecord record;

  static std::int32_t ordered_w(std::int64_t s) { return s / 2'400 % 2 == 0 ? 4'000 : -4'000; }
  void read(std::int64_t s, std::int32_t power_w, int every_s) {
    Reading now{.purpose = s % 120 == 100 ? ReadingPurpose::kTick : ReadingPurpose::kCheck,
                .is_read = true,
                .is_under_control = true,
                .response = driven_reading(s, ordered_w(s), power_w)};
    now.response.order_age_s = static_cast<std::int32_t>(s % 2'400);
    cells.move(now.response, every_s);
    part.observe(now);
    part.report(record);
  }
};

/// The first minute of each quarter-hour, which no tick's reading shows.
TEST(WrongEnergy, ReadingsBetweenTicksCount) {
  WatchedSite site;
  std::int64_t s = 0;
  while (s < 12 * 3'600 && !site.record.is_tripped) {
    s += 20;
    const std::int32_t ordered_w = WatchedSite::ordered_w(s);
    site.read(s, s % 900 < 60 ? -ordered_w : ordered_w, 20);
  }
  EXPECT_EQ(site.record.trip.reason, Reason::kWrongDirection);
  EXPECT_NEAR(static_cast<double>(s) / 900, 12 / 0.5, 4);  // 67 Wh of 8 kWh each, 0.83 %
}

TEST(WrongEnergy, ABatteryOnItsWayBetweenTicksIsNotWrong) {
  WatchedSite site;
  std::int32_t power_w = 4'000;
  for (std::int64_t s = 10; s < 12 * 3'600; s += 10) {
    power_w += std::clamp(WatchedSite::ordered_w(s) - power_w, -300, 300);  // 30 W/s
    site.read(s, power_w, 10);
    ASSERT_EQ(site.record.findings.wrong_energy_e6, 0) << s;
    ASSERT_FALSE(site.record.is_tripped) << s;
  }
}

}  // namespace
}  // namespace bess
