// What kept the student from deciding, and what that cost: by hand at prices at which the student
// must charge or discharge, whatever it has learnt.
#include "edge/account/stops.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStopStart = 1'679'785'200;

CycleRecord stop_cycle(int i, std::int32_t price_eur, std::int32_t power_w, std::int32_t soc_e4,
                       Reason reason, Mode mode) {
  CycleRecord record{.utc_s = kStopStart + i * kSecondsPerStep, .mode = mode, .reason = reason};
  record.has_measurement = soc_e4 >= 0;
  record.measurement.power_w = power_w;
  record.measurement.soc_e4 = soc_e4;
  record.price.has_row = true;
  record.price.price_centi_eur_per_mwh = price_eur * 100;
  record.price.minute_utc_s = record.utc_s - 60;
  record.context_class = 6;
  return record;
}

/// 4 kW, 8 kWh.
Stops stops_of(const std::vector<CycleRecord>& records, const SettledPrices& settled = {}) {
  set_market_time_zone();
  QuarterPrices prices(settled);
  for (const CycleRecord& record : records) prices.note(record);
  StopBook book({.power_w_max = 4'000, .capacity_wh = 8'000},
                {.low_eur_per_mwh = -500, .high_eur_per_mwh = 1'500}, prices);
  for (const CycleRecord& record : records) book.add(record);
  return book.stops();
}

/// Fifteen cycles decided at 2,000 EUR/MWh, in which it may not discharge: 2 kWh, two quarter-hours
/// that are settled at 1,800; what is left in the battery is worth the mean of these and of as much
/// at 200.
TEST(Stops, CostWhatTheStudentWouldHaveEarned) {
  std::vector<CycleRecord> records;
  for (int i = 0; i < 15; ++i)
    records.push_back(stop_cycle(i, 2'000, 0, 9'000, Reason::kTemperature, Mode::kHolding));
  for (int i = 15; i < 30; ++i)
    records.push_back(stop_cycle(i, 200, 0, 9'000, Reason::kStudent, Mode::kRunning));
  SettledPrices settled;
  settled.put(std::vector<SettledQuarter>{{kStopStart, 1'800}, {kStopStart + 900, 1'800}});
  const Stops found = stops_of(records, settled);
  ASSERT_EQ(found.by_reason.size(), 1u);
  const Stop& stop = found.by_reason.front();
  EXPECT_EQ(stop.reason, Reason::kTemperature);
  EXPECT_EQ(stop.cycles, 15);
  EXPECT_EQ(stop.not_driven, 15);
  EXPECT_EQ(stop.valued, 15);
  const double out_mwh = 2.0 / 1'000;
  EXPECT_NEAR(stop.cost_eur, out_mwh * 1'800 - out_mwh / 0.9 * 1'000, 1e-6);
  EXPECT_NEAR(found.driven_share(), 0.5, 1e-12);
  EXPECT_THAT(stops_text(found), HasSubstr("driven 50.0 % of the time"));
  EXPECT_THAT(stops_text(found),
              HasSubstr("temperature           15 cycles,    15 not driven, cost "));
}

/// Held at the very power that the student would have ordered: nothing is lost.
TEST(Stops, WhatTheStudentWouldHaveDoneCostsNothing) {
  std::vector<CycleRecord> records;
  double soc_frac = 0.9;
  const BatteryParameters battery{.power_w_max = 4'000, .capacity_wh = 8'000};
  for (int i = 0; i < 5; ++i) {
    records.push_back(stop_cycle(i, 2'000, i == 0 ? 0 : -4'000,
                                 static_cast<std::int32_t>(soc_frac * 1e4 + 0.5),
                                 i < 4 ? Reason::kHeld : Reason::kStudent, Mode::kRunning));
    soc_frac = battery_step(battery, soc_frac, -4'000, kHoursPerStep).soc_frac;
  }
  const Stops found = stops_of(records);
  ASSERT_EQ(found.by_reason.size(), 1u);
  EXPECT_EQ(found.by_reason.front().not_driven, 0);
  EXPECT_NEAR(found.cost_eur(), 0, 1e-3);  // the SoC is rounded
}

TEST(Stops, WhatCannotBeToldIsNotInvented) {
  std::vector<CycleRecord> records;
  for (int i = 0; i < 5; ++i)
    records.push_back(stop_cycle(i, 2'000, 0, -1, Reason::kLink, Mode::kSafe));
  records.push_back(stop_cycle(9, 200, 0, 5'000, Reason::kStudent, Mode::kRunning));
  records.push_back(stop_cycle(10, 200, 0, 5'000, Reason::kSocFull, Mode::kRunning));
  const Stops found = stops_of(records);
  EXPECT_EQ(found.missing_cycles, 4);
  EXPECT_NEAR(found.driven_share(), 2.0 / 11, 1e-12);
  ASSERT_EQ(found.by_reason.size(), 1u);  // a full battery stops nobody
  EXPECT_EQ(found.by_reason.front().valued, 0);
  EXPECT_THAT(stops_text(found), HasSubstr("4 cycles have no record"));
  EXPECT_THAT(stops_text(found), HasSubstr("cost not known"));
  EXPECT_TRUE(stops_json(found).value()["by_reason"].begin().operator*()["cost_eur"].is_null());
}

}  // namespace
}  // namespace bess
