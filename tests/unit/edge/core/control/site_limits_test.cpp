// Site limits: energy of the quarter-hour, the line of the outside limit, and the result when the
// meter or the limit is lost.
#include "edge/core/site/site_limits.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kQuarter = 1'679'788'800;  // a whole quarter-hour
static_assert(kQuarter % 900 == 0);

TEST(QuarterHourEnergy, ImportIsTheSumOfWhatWasMeasured) {
  QuarterHourEnergy energy(2'500, 30);
  energy.add(kQuarter, 1'000, 500);
  energy.add(kQuarter + 10, 2'000, 500);
  energy.add(kQuarter + 20, -4'000,
             -1'000);  // export does not count negative; the time of the change is unknown
  const auto sums = energy.at(kQuarter + 20);
  EXPECT_EQ(sums.import_ws, 10 * 1'500 + 10 * 1'000);
  EXPECT_EQ(sums.battery_ws, 20 * 500);
  EXPECT_EQ(sums.left_s, 880);
  EXPECT_EQ(energy.at(kQuarter + 25).import_ws, sums.import_ws);
}

TEST(QuarterHourEnergy, TheNextQuarterHourBeginsWithItsOwnPart) {
  QuarterHourEnergy energy(2'500, 30);
  energy.add(kQuarter + 890, 3'600, 0);
  energy.add(kQuarter + 905, 3'600, 0);
  EXPECT_EQ(energy.at(kQuarter + 905).import_ws, 5 * 3'600);
  EXPECT_EQ(energy.at(kQuarter + 905).left_s, 895);
  EXPECT_EQ(energy.at(kQuarter + 899).left_s, 895);  // never before its newest reading
}

TEST(QuarterHourEnergy, WhatWasNotMeasuredCountsAsTheCapOrMore) {
  QuarterHourEnergy start(2'500, 30);
  start.add(kQuarter + 100, 300, 0);
  EXPECT_EQ(start.at(kQuarter + 100).import_ws, 100 * 2'500);
  QuarterHourEnergy gap(2'500, 30);
  gap.add(kQuarter, 300, 1'000);
  gap.add(kQuarter + 31, 4'000, 0);  // more than the cap: then that
  EXPECT_EQ(gap.at(kQuarter + 31).import_ws, 31 * 4'000);
  EXPECT_EQ(gap.at(kQuarter + 31).battery_ws, 31 * 1'000);
}

TEST(QuarterHourEnergy, ARestartContinuesFromTheLog) {
  QuarterHourEnergy energy(2'500, 30);
  energy.restore(kQuarter + 120, 100, 20);
  energy.add(kQuarter + 140, 300, 0);
  EXPECT_EQ(energy.at(kQuarter + 140).import_ws, 100 * 3'600 + 20 * 2'500);
  EXPECT_EQ(energy.at(kQuarter + 140).battery_ws, 20 * 3'600);
  QuarterHourEnergy later(2'500, 30);
  later.restore(kQuarter + 120, 100, 20);
  later.add(kQuarter + 910, 300, 0);  // another quarter-hour: none of it counts
  EXPECT_EQ(later.at(kQuarter + 910).import_ws, 10 * 2'500);
  EXPECT_EQ(later.at(kQuarter + 910).battery_ws, 0);
  QuarterHourEnergy stepped(2'500, 30);  // the log was written while the clock was ahead
  stepped.restore(kQuarter + 600, 400, 0);
  stepped.add(kQuarter + 300, 300, 0);
  EXPECT_EQ(stepped.at(kQuarter + 300).import_ws, 300 * 2'500);
}

TEST(OutsideLimit, IsOneLineOfThreeWords) {
  OutsideLimit limit;
  ASSERT_EQ(parse_outside_limit("0 any 2023-03-26T00:15:00Z\n", limit), Status::kOk);
  EXPECT_EQ(limit.charge_w_max, 0);
  EXPECT_EQ(limit.discharge_w_max, kAnyPowerW);
  EXPECT_EQ(limit.until_utc_s, kQuarter + 900);
  for (const char* const text :
       {"", "\n", "0 0\n", "0 0 2023-03-26T00:15:00Z", "0 0 2023-03-26T00:15:00\n",
        "-1 0 2023-03-26T00:15:00Z\n", "0 1.5 2023-03-26T00:15:00Z\n",
        "0  0 2023-03-26T00:15:00Z\n", "0 0 2023-03-26T00:15:00Z 0\n",
        "99999999999 0 2023-03-26T00:15:00Z\n", "0 0 2023-03-26T00:15:00Z\n\n"}) {
    EXPECT_EQ(parse_outside_limit(text, limit), Status::kMalformed) << text;
  }
}

struct StubMeter {
  Status status = Status::kOk;
  std::int32_t grid_w = 0;
  Status read(std::int32_t& grid_power_w) {
    if (status == Status::kOk) grid_power_w = grid_w;
    return status;
  }
};

struct StubLimits {
  Status status = Status::kOk;
  bool is_set = false;
  OutsideLimit limit;
  Status read(OutsideLimit& out, bool& set) {
    out = limit;
    set = is_set && status == Status::kOk;
    return status;
  }
};

using Site = SiteLimits<StubMeter, StubLimits>;

struct SiteUnderTest {
  explicit SiteUnderTest(SiteSettings settings) : site(settings, &meter, &limits) {}
  void observe(std::int64_t utc_s, bool is_read = true, std::int32_t battery_w = 0) {
    BatteryMeasurement m;
    m.power_w = battery_w;
    site.observe(utc_s, is_read, m, {});
  }
  [[nodiscard]] SiteRange range(std::int64_t utc_s, Margin margin = Margin::kWhole) const {
    return site.range(utc_s, margin);
  }
  StubMeter meter;
  StubLimits limits;
  Site site;
};

/// A site with a limit from outside and no meter.
SiteSettings limited() {
  SiteSettings settings;
  settings.has_outside_limits = true;
  return settings;
}

SiteSettings metered() {
  SiteSettings settings;
  settings.meter = MeterSource::kMap;
  settings.connection.import_w_max = 5'000;
  settings.connection.margin_w = 0;
  return settings;
}

TEST(SiteLimits, TheHouseIsWhatGridAndBatteryLeave) {
  SiteUnderTest t(metered());
  t.meter.grid_w = 4'500;
  t.observe(kQuarter, true, 3'000);
  EXPECT_EQ(t.range(kQuarter).charge_w_max, 3'500);
  EXPECT_TRUE(t.site.report(kQuarter).has_grid_power);
  EXPECT_EQ(t.site.report(kQuarter).grid_power_w, 4'500);
}

TEST(SiteLimits, AnOrderInForceMayUseHalfOfTheMargin) {
  SiteSettings settings = metered();
  settings.connection.margin_w = 300;
  SiteUnderTest t(settings);
  t.observe(kQuarter);
  EXPECT_EQ(t.range(kQuarter).charge_w_max, 4'700);
  EXPECT_EQ(t.range(kQuarter, Margin::kHalf).charge_w_max, 4'850);
}

TEST(SiteLimits, ALostMeterIsIdleOnlyAfterItsLastReadingIsTooOld) {
  SiteUnderTest t(metered());
  t.observe(kQuarter);
  t.meter.status = Status::kTimeout;
  t.observe(kQuarter + 30);
  EXPECT_EQ(t.range(kQuarter + 30).charge_reason, Reason::kImportLimit);
  EXPECT_EQ(t.site.report(kQuarter + 30).meter_status, Status::kTimeout);
  const SiteRange lost = t.range(kQuarter + 31);
  EXPECT_EQ(lost.charge_w_max, 0);
  EXPECT_EQ(lost.discharge_w_max, 0);
  EXPECT_EQ(lost.charge_reason, Reason::kMeterLost);
  EXPECT_FALSE(t.site.report(kQuarter + 31).has_grid_power);
  SiteSettings ignoring = metered();
  ignoring.idle_without_meter = false;
  SiteUnderTest u(ignoring);
  EXPECT_EQ(u.range(kQuarter).charge_w_max, kAnyPowerW);
}

TEST(SiteLimits, WithoutTheBatterysPowerThereIsNoReading) {
  SiteUnderTest t(metered());
  t.observe(kQuarter, false);
  EXPECT_EQ(t.range(kQuarter).charge_reason, Reason::kMeterLost);
}

TEST(SiteLimits, TheBatterysOwnGridPointServesAsWell) {
  SiteSettings settings = metered();
  settings.meter = MeterSource::kBattery;
  SiteUnderTest t(settings);
  BatteryMeasurement m;
  m.has_grid_power = true;
  m.grid_power_w = 1'000;
  t.site.observe(kQuarter, true, m, {});
  EXPECT_EQ(t.range(kQuarter).charge_w_max, 4'000);
  m.has_grid_power = false;
  t.site.observe(kQuarter + 40, true, m, {});
  EXPECT_EQ(t.range(kQuarter + 40).charge_reason, Reason::kMeterLost);
}

TEST(SiteLimits, AnOutsideLimitEndsByItself) {
  SiteUnderTest t(limited());
  t.limits.is_set = true;
  t.limits.limit = {
      .charge_w_max = 700, .discharge_w_max = kAnyPowerW, .until_utc_s = kQuarter + 60};
  t.observe(kQuarter);
  EXPECT_EQ(t.range(kQuarter + 59).charge_w_max, 700);
  EXPECT_EQ(t.range(kQuarter + 59).charge_reason, Reason::kOutsideLimit);
  EXPECT_EQ(t.range(kQuarter + 59).discharge_w_max, kAnyPowerW);
  EXPECT_EQ(t.range(kQuarter + 60).charge_w_max, kAnyPowerW);
  EXPECT_EQ(t.site.report(kQuarter + 60).limit_status, Status::kOk);
}

TEST(SiteLimits, AMissingRequiredLimitLeavesTheBatteryIdle) {
  SiteSettings settings = limited();
  settings.idle_after_timeout = true;
  SiteUnderTest t(settings);
  t.observe(kQuarter);
  EXPECT_EQ(t.range(kQuarter).charge_w_max, 0);
  EXPECT_EQ(t.site.report(kQuarter).limit_status, Status::kTimeout);
  t.limits.is_set = true;
  t.limits.limit.until_utc_s = kQuarter + 60;  // without any limit: only a sign of life
  t.observe(kQuarter);
  EXPECT_EQ(t.range(kQuarter).charge_w_max, kAnyPowerW);
  EXPECT_EQ(t.range(kQuarter + 60).charge_w_max, 0);
}

TEST(SiteLimits, AMalformedLimitIsIdle) {
  SiteUnderTest t(limited());
  t.limits.status = Status::kMalformed;
  t.observe(kQuarter);
  EXPECT_EQ(t.range(kQuarter).charge_w_max, 0);
  EXPECT_EQ(t.range(kQuarter).discharge_w_max, 0);
  EXPECT_EQ(t.site.report(kQuarter).limit_status, Status::kMalformed);
}

TEST(SiteLimits, OfSeveralLimitsTheTightestNamesTheReason) {
  SiteSettings settings = metered();
  settings.has_outside_limits = true;
  SiteUnderTest t(settings);
  t.limits.is_set = true;
  t.limits.limit = {.charge_w_max = 2'000, .discharge_w_max = 100, .until_utc_s = kQuarter + 60};
  t.meter.grid_w = 4'000;
  t.observe(kQuarter);
  const SiteRange range = t.range(kQuarter);
  EXPECT_EQ(range.charge_w_max, 1'000);
  EXPECT_EQ(range.charge_reason, Reason::kImportLimit);
  EXPECT_EQ(range.discharge_w_max, 100);
  EXPECT_EQ(range.discharge_reason, Reason::kOutsideLimit);
}

}  // namespace
}  // namespace bess
