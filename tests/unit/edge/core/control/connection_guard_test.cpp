// Limits of the connection: hand-made cases for each limit, and invariants for any load and limit.
#include "edge/core/site/connection_guard.h"

#include <gtest/gtest.h>

#include <random>

namespace bess {
namespace {

constexpr std::int32_t kBatteryW = 4'000;

SiteRange range_of(const ConnectionSettings& settings, const ConnectionState& state) {
  SiteRange range;
  limit_at_connection(settings, settings.margin_w, state, range);
  return range;
}

/// The battery charges 1 kW, the house takes 2 kW.
ConnectionState at_3_kw(std::int64_t import_ws = 0, std::int32_t left_s = 900) {
  return {.grid_w = 3'000,
          .battery_w = 1'000,
          .quarter_hour = {.import_ws = import_ws, .left_s = left_s}};
}

TEST(ConnectionGuard, WithoutLimitsNothingIsLimited) {
  const SiteRange range = range_of({}, at_3_kw());
  EXPECT_EQ(range.charge_w_max, kAnyPowerW);
  EXPECT_EQ(range.discharge_w_max, kAnyPowerW);
  EXPECT_EQ(range.relief_w, 0);
}

TEST(ConnectionGuard, ImportLeavesTheHouseFirst) {
  const SiteRange range = range_of({.import_w_max = 5'000, .margin_w = 100}, at_3_kw());
  EXPECT_EQ(range.charge_w_max, 5'000 - 100 - 2'000);
  EXPECT_EQ(range.charge_reason, Reason::kImportLimit);
  EXPECT_EQ(range.discharge_w_max, kAnyPowerW);
  const SiteRange overloaded = range_of({.import_w_max = 1'500}, at_3_kw());
  EXPECT_EQ(overloaded.charge_w_max, 0);  // the house alone is above it
  EXPECT_EQ(overloaded.relief_w, 0);
}

TEST(ConnectionGuard, ExportCountsWhatTheHouseTakes) {
  const SiteRange range = range_of({.export_w_max = 1'000, .margin_w = 100}, at_3_kw());
  EXPECT_EQ(range.discharge_w_max, 1'000 - 100 + 2'000);
  EXPECT_EQ(range.discharge_reason, Reason::kExportLimit);
  ConnectionState sunny = at_3_kw();
  sunny.grid_w = -3'000;  // 4 kW surplus of sun, of which the battery takes 1
  EXPECT_EQ(range_of({.export_w_max = 1'000}, sunny).discharge_w_max, 0);
  EXPECT_EQ(range_of({.export_w_max = 0, .margin_w = 0}, at_3_kw()).discharge_w_max, 2'000);
}

TEST(ConnectionGuard, TheQuarterHoursMeanStaysUnderItsCap) {
  const ConnectionSettings settings{.peak_w_max = 3'000, .margin_w = 0};
  EXPECT_EQ(range_of(settings, at_3_kw()).charge_w_max, 1'000);  // from the start: cap less house
  // A third of it is gone at 1.5 kW: the rest may be proportionally higher.
  const SiteRange saved = range_of(settings, at_3_kw(300 * 1'500, 600));
  EXPECT_EQ(saved.charge_w_max, (3'000 * 900 - 300 * 1'500) / 600 - 2'000);
  EXPECT_EQ(saved.charge_reason, Reason::kQuarterHourPeak);
  EXPECT_EQ(range_of(settings, at_3_kw(3'000 * 900, 300)).charge_w_max, 0);
}

/// The order of this step extends into the next quarter-hour, where nothing is saved yet.
TEST(ConnectionGuard, WhatIsLeftOfAQuarterHourIsNotSpentInTheNext) {
  const ConnectionSettings settings{.peak_w_max = 3'000, .margin_w = 0};
  EXPECT_GT(range_of(settings, at_3_kw(0, 120)).charge_w_max, 4'000);
  EXPECT_EQ(range_of(settings, at_3_kw(0, 119)).charge_w_max, 1'000);
}

TEST(ConnectionGuard, ReliefGivesBackWhatTheBatteryTookAndNoMore) {
  const ConnectionSettings settings{.peak_w_max = 3'000, .margin_w = 0};
  ConnectionState state{.grid_w = 6'000};
  state.quarter_hour = {.import_ws = 450 * 2'500, .battery_ws = 90'000, .left_s = 450};
  SiteRange range = range_of(settings, state);
  EXPECT_EQ(range.charge_w_max, 0);
  EXPECT_EQ(range.relief_w, 200);  // 90 kWs in 450 s, although 2.5 kW too much
  ConnectionSettings shaving = settings;
  shaving.peak_shave = true;
  EXPECT_EQ(range_of(shaving, state).relief_w, 2'500);
  state.grid_w = 1'000;  // the house alone stays below it
  EXPECT_EQ(range_of(shaving, state).relief_w, 0);
}

struct Draw {
  ConnectionSettings settings;
  ConnectionState state;
};

Draw drawn(std::mt19937_64& random) {
  const auto any = [&](int min, int max) {
    return std::uniform_int_distribution<>(min, max)(random);
  };
  Draw d;
  d.settings.margin_w = any(0, 500);
  if (any(0, 2) > 0) d.settings.import_w_max = any(500, 20'000);
  if (any(0, 2) > 0) d.settings.export_w_max = any(0, 10'000);
  if (any(0, 3) > 0) d.settings.peak_w_max = any(600, 8'000);
  d.settings.peak_shave = any(0, 3) == 0;
  d.state.battery_w = any(-kBatteryW, kBatteryW);
  d.state.grid_w = d.state.battery_w + any(-8'000, 12'000);
  const std::int32_t left_s = any(1, 900);
  d.state.quarter_hour = {.import_ws = std::int64_t{any(0, 12'000)} * (900 - left_s),
                          .battery_ws = std::int64_t{any(0, 4'000)} * (900 - left_s),
                          .left_s = left_s};
  return d;
}

TEST(ConnectionGuard, HoldsItsPromisesForAnyLoadAndLimit) {
  std::mt19937_64 random(12);
  int limited = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto& [settings, state] = drawn(random);
    const SiteRange range = range_of(settings, state);
    const std::int64_t house_w = std::int64_t{state.grid_w} - state.battery_w;
    const auto& now = state.quarter_hour;
    ASSERT_GE(range.charge_w_max, 0);
    ASSERT_GE(range.discharge_w_max, 0);
    if (range.charge_w_max > 0 && settings.import_w_max != kAnyPowerW) {
      ASSERT_LE(house_w + range.charge_w_max, settings.import_w_max - settings.margin_w);
    }
    if (range.discharge_w_max > 0 && settings.export_w_max != kAnyPowerW) {
      ASSERT_LE(range.discharge_w_max - house_w, settings.export_w_max - settings.margin_w);
    }
    if (settings.peak_w_max == kAnyPowerW) continue;
    const std::int64_t cap_ws = std::int64_t{settings.peak_w_max - settings.margin_w} * 900;
    const std::int64_t charge_w = range.charge_w_max;
    if (charge_w > 0) {
      ++limited;
      ASSERT_LE(now.import_ws + (house_w + charge_w) * now.left_s, cap_ws);
      ASSERT_EQ(range.relief_w, 0);  // never requests both
    }
    ASSERT_GE(range.relief_w, 0);
    ASSERT_LE(range.relief_w, std::max<std::int64_t>(house_w, 0));
    if (!settings.peak_shave && range.relief_w > 0) {
      ASSERT_LT(std::int64_t{range.relief_w} * now.left_s, now.battery_ws + now.left_s);
    }
    ConnectionState more = state;  // more load never allows more
    more.grid_w += 100;
    ASSERT_LE(range_of(settings, more).charge_w_max, range.charge_w_max);
    ASSERT_GE(range_of(settings, more).discharge_w_max, range.discharge_w_max);
  }
  EXPECT_GT(limited, 10'000);
}

}  // namespace
}  // namespace bess
