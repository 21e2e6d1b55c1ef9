// Holds, reserve, full charges and the spread of starts in the real control loop, on a fake clock.
#include <gtest/gtest.h>

#include "tests/support/fake_plant.h"

namespace bess {
namespace {

struct Site : FakePlant {
  explicit Site(const ControlSettings& settings = {.control = true, .guard = {}})
      : FakePlant(0.5, settings) {
    set_market_time_zone();
    loop.follow_holds(holds);
  }
  void hold(std::int32_t power_w, std::int64_t seconds) {
    const std::int64_t now_utc_s = clock.now_ns / kNanosecondsPerSecond;
    holds.publish(
        {.power_w = power_w, .until_utc_s = static_cast<std::uint32_t>(now_utc_s + seconds)});
  }

  LatestHold holds;
};

TEST(LoopWithAHold, AnUnreadableOneIsReportedAndNotFollowed) {
  Site site;
  site.set_price(-20'000);
  site.holds.publish({.unreadable = true});
  const CycleRecord record = site.cycle();
  EXPECT_TRUE(record.hold.unreadable);
  EXPECT_EQ(record.ordered_power_w, 4'000);
}

TEST(LoopWithAHold, ReadOnlySaysWhatItWouldOrder) {
  Site site(ControlSettings{});
  site.hold(-500, 3'600);
  const CycleRecord record = site.cycle();
  EXPECT_EQ(record.ordered_power_w, -500);
  EXPECT_EQ(record.reason, Reason::kHeld);
  EXPECT_FALSE(record.written);
  EXPECT_TRUE(site.battery.orders.empty());
}

TEST(LoopWithAReserve, ALowerOneThanSocMinChangesNothing) {
  ControlSettings settings{.control = true, .guard = {}};
  settings.reserve.push_back({.soc_e4 = 500});
  Site site(settings);
  site.cycle();
  EXPECT_EQ(site.battery.orders.back().soc_min_e4, 1'000);
}

/// Waves that never fill it: from its due day on, the battery charges to full, once.
TEST(LoopWithFullCharges, FillsTheBatteryWhenItIsDue) {
  ControlSettings settings{.control = true, .guard = {}};
  settings.full_charge_every_days = 3;
  settings.guard.soc_max_e4 = 10'000;
  Site site(settings);
  site.prices.price = [](std::int64_t minute_utc_s) {  // high price: the student sells, or rests
    const auto cents = static_cast<std::int32_t>(minute_utc_s / 60 % 97);  // it is not frozen
    return (minute_utc_s % 3'600 < 1'800 ? 30'000 : 25'000) + cents;
  };
  int due_cycles = 0;
  std::int32_t fullest_e4 = 0;
  for (int i = 0; i < 6 * kStepsPerDay && fullest_e4 < FullCharge::kFullE4; ++i) {
    const CycleRecord record = site.cycle();
    if (record.measurement.soc_e4 > fullest_e4) fullest_e4 = record.measurement.soc_e4;
    if (record.reason != Reason::kFullCharge) continue;
    ++due_cycles;
    EXPECT_GE(record.days_since_full, 3);
    EXPECT_GE(record.ordered_power_w, 0);
    EXPECT_LE(record.ordered_power_w, 2'000);
  }
  EXPECT_GT(due_cycles, 0);
  EXPECT_GE(fullest_e4, FullCharge::kFullE4);
  EXPECT_EQ(site.cycle().days_since_full, 0);
}

TEST(LoopWithFullCharges, ARestartContinuesTheCount) {
  ControlSettings settings{.control = true, .guard = {}};
  settings.full_charge_every_days = 3;
  Site site(settings);
  site.set_price(5'000);
  site.loop.take_over(
      {.utc_s = kDayStartS, .price_level = PriceLevel::starting_at(8'000), .days_since_full = 3});
  const CycleRecord record = site.cycle();
  EXPECT_EQ(record.days_since_full, 3);
  EXPECT_EQ(record.reason, Reason::kFullCharge);
  EXPECT_EQ(record.ordered_power_w, 2'000);
}

}  // namespace
}  // namespace bess
