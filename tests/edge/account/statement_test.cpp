// Some days together: sums by hand, the charge at both ends, and the same numbers as text, CSV and
// JSON.
#include "edge/account/statement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bess {
namespace {

using ::testing::HasSubstr;

/// Half an hour at that power and price, from that SoC to that one.
void add_half_hour(DayAccount& day, std::int64_t from_utc_s, std::int32_t power_w,
                   std::int32_t price_centi, std::int32_t from_e4, std::int32_t to_e4) {
  for (int i = 0; i < 15; ++i) {
    CycleRecord r{
        .utc_s = from_utc_s + i * 120, .mode = Mode::kRunning, .reason = Reason::kStudent};
    r.has_measurement = true;
    r.measurement.power_w = power_w;
    r.measurement.capacity_wh = 8'000;
    r.measurement.soc_e4 = from_e4 + (to_e4 - from_e4) * i / 14;
    r.price.has_row = true;
    r.price.price_centi_eur_per_mwh = price_centi;
    day.add(r);
  }
}

/// 2 kWh in at 50 EUR/MWh on the first day, 1 kWh out at 250 on the second: half of it is left.
Statement two_days() {
  DayAccount first(20'261'122);
  DayAccount second(20'261'123);
  add_half_hour(first, 1'000'000, 4'000, 5'000, 3'000, 5'500);
  add_half_hour(second, 1'086'400, -2'000, 25'000, 5'500, 4'250);
  CycleRecord stale{.utc_s = 1'100'000, .mode = Mode::kHolding, .reason = Reason::kPriceAge};
  second.add(stale);
  return Statement({first, second});
}

TEST(Statements, AddUp) {
  const Statement both = two_days();
  EXPECT_NEAR(both.earned_eur(), -0.10 + 0.25, 1e-12);
  EXPECT_NEAR(both.charged_kwh(), 2, 1e-12);
  EXPECT_NEAR(both.discharged_kwh(), 1, 1e-12);
  EXPECT_NEAR(both.stored_kwh(), (0.425 - 0.30) * 8, 1e-12);
  EXPECT_NEAR(both.mean_price_eur_per_mwh(), 150, 1e-12);
  EXPECT_NEAR(both.stored_eur(), 0.15, 1e-12);
}

TEST(Statements, SayTheSameInEachForm) {
  const Statement both = two_days();
  const std::string text = both.text();
  EXPECT_THAT(text, HasSubstr("2026-11-22       -0.10          2.0             0.0"));
  EXPECT_THAT(text, HasSubstr("together         +0.15          2.0             1.0"));
  EXPECT_THAT(text, HasSubstr("1.0 kWh more are stored than at the beginning, worth 0.15 EUR"));
  EXPECT_THAT(text, HasSubstr("+0.30 EUR with the same charge at both ends"));
  EXPECT_THAT(text, HasSubstr("cycles that the student did not decide: price_age 1\n"));
  EXPECT_THAT(both.csv(),
              HasSubstr("2026-11-23,0.2500,0.000,1.000,0.0000,16,15,15,250.00,55.00,42.50\n"));
  const Json json = Json::parse(both.json().text());
  EXPECT_DOUBLE_EQ(json.value()["earned_eur"].number().value(), 0.15);
  EXPECT_DOUBLE_EQ(json.value()["earned_at_equal_soc_eur"].number().value(), 0.30);
  EXPECT_EQ(json.value()["days"].size(), 2u);
  for (const JsonValue day : json.value()["days"]) {
    EXPECT_THAT(both.csv(), HasSubstr(std::string(day["date"].text()) + ","));
  }
}

TEST(Statements, ADayThatWasNeverMeasuredMovesNoCharge) {
  DayAccount blind(20'261'121);
  blind.add(CycleRecord{.utc_s = 900'000, .mode = Mode::kSafe, .reason = Reason::kLink});
  DayAccount seen(20'261'122);
  add_half_hour(seen, 1'000'000, 4'000, 5'000, 3'000, 5'500);
  const Statement both({blind, seen});
  EXPECT_NEAR(both.stored_kwh(), 2, 1e-12);
  EXPECT_THAT(both.csv(), HasSubstr("2026-11-21,0.0000,0.000,0.000,0.0000,1,0,0,0.00,,\n"));
}

}  // namespace
}  // namespace bess
