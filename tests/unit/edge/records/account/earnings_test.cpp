// Sums over days: computed by hand, the charge at both ends, and the same numbers as CSV and JSON.
#include "edge/records/account/day_accounts.h"

#include <gmock/gmock.h>

#include <cmath>

#include "shared/local_time.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kEarningsStart = 1'795'341'600;  // 2026-11-22T10:00:00Z

/// Half an hour at that power and price, from that SoC to that one.
void add_half_hour(DayAccounts& day_accounts, std::int64_t from_utc_s, std::int32_t power_w,
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
    r.price.minute_utc_s = r.utc_s - 60;
    r.ordered_power_w = i < 14 ? power_w : 0;
    r.written = true;
    day_accounts.add(r);
  }
}

/// 2 kWh in at 50 EUR/MWh on the first day, 1 kWh out at 250 on the second: half of it remains.
std::vector<DayAccount> two_days(const MoneyTerms& terms = {}) {
  set_market_time_zone();
  DayAccounts day_accounts(20'261'122, 20'261'123, terms);
  add_half_hour(day_accounts, kEarningsStart, 4'000, 5'000, 3'000, 5'500);
  CycleRecord rest{
      .utc_s = kEarningsStart + 15 * 120, .mode = Mode::kRunning, .reason = Reason::kStudent};
  rest.has_measurement = true;
  rest.measurement.soc_e4 = 5'500;
  day_accounts.add(rest);
  rest.utc_s = kEarningsStart + 86'400 - 120;
  rest.ordered_power_w = -2'000;
  rest.written = true;
  day_accounts.add(rest);
  add_half_hour(day_accounts, kEarningsStart + 86'400, -2'000, 25'000, 5'500, 4'250);
  day_accounts.add(
      {.utc_s = kEarningsStart + 90'000, .mode = Mode::kHolding, .reason = Reason::kPriceAge});
  return day_accounts.accounts();
}

TEST(EarningsOfDays, AddUp) {
  const std::vector<DayAccount> both = two_days({.capacity_wh = 8'000});
  const DayAccount all = sum_of(both);
  EXPECT_NEAR(all.exchanged.money.earned_eur, -0.10 + 0.25, 1e-9);
  EXPECT_NEAR(all.charged_kwh(), 2, 1e-9);
  EXPECT_NEAR(all.discharged_kwh(), 1, 1e-9);
  EXPECT_NEAR(all.unseen_kwh(), 0, 1e-9);
  EXPECT_NEAR(all.stored_kwh(), (0.425 - 0.30) * 8, 1e-9);
  // Three quarter-hours each, of the first and of the second day; stored energy has losses.
  EXPECT_NEAR(all.exchanged.money.mean_price_eur_per_mwh(), 150, 1e-9);
  EXPECT_NEAR(all.stored_eur(), 0.15 * std::sqrt(0.9), 1e-9);
  EXPECT_NEAR(all.exchanged.money.estimated_eur, 0.15, 1e-9);
}

/// 2 kWh in and 1 kWh out, in three quarter-hours each; the first of the second day is published at
/// 300 EUR/MWh, the second validated at 100: 0.0667 kWh, 0.5 kWh; the rest at the indicative 250.
TEST(EarningsOfDays, AreBilledByQuarterHoursAsFarAsTheyAreSettled) {
  MoneyTerms terms{.capacity_wh = 8'000};
  const std::int64_t second = kEarningsStart + 86'400;
  const SettledQuarter settled[] = {{second - 900, 300, PriceState::kPublished},
                                    {second, 100, PriceState::kValidated}};
  terms.settled.put(settled);
  const std::vector<DayAccount> both = two_days(terms);
  const QuarterHourMoney money = sum_of(both).exchanged.money;
  const double before_kwh = 2.0 / 30, then_kwh = 0.5, last_kwh = 1 - before_kwh - then_kwh;
  const double out_eur = (before_kwh * 300 + then_kwh * 100 + last_kwh * 250) / 1'000;
  EXPECT_NEAR(money.earned_eur, -0.10 + out_eur, 1e-9);
  EXPECT_NEAR(money.estimated_eur, -0.10 + last_kwh * 0.25, 1e-9);
  EXPECT_EQ(money.contract_eur, 0);
  EXPECT_EQ(money.published, 2);
  EXPECT_EQ(money.validated, 1);
  EXPECT_EQ(Json::parse(earnings_json(both).text()).value()["settled_quarter_hours"].number(), 2);
}

TEST(EarningsOfDays, AreTheSameInCsvAndJson) {
  const std::vector<DayAccount> both = two_days({.capacity_wh = 8'000});
  EXPECT_THAT(
      earnings_csv(both),
      HasSubstr("2026-11-23,0.2500,0.000,1.000,0.0000,17,16,15,250.00,55.00,42.50,3,0,0,0,"));
  const Json json = Json::parse(earnings_json(both).text());
  EXPECT_DOUBLE_EQ(json.value()["earned_eur"].number().value(), 0.15);
  EXPECT_DOUBLE_EQ(json.value()["earned_at_equal_soc_eur"].number().value(), 0.2923);
  EXPECT_EQ(json.value()["days"].size(), 2u);
  const JsonValue first = *json.value()["days"].begin();
  EXPECT_STREQ(first["date"].text(), "2026-11-22");
  EXPECT_STREQ(first["start_utc"].text(), "2026-11-21T23:00:00Z");
  EXPECT_EQ(first["interventions"].number(), 0);
  EXPECT_EQ(std::string(first["line"].text_or("")).find("2026-11-22: "), 0u);
  for (const JsonValue day : json.value()["days"]) {
    EXPECT_THAT(earnings_csv(both), HasSubstr(std::string(day["date"].text()) + ","));
  }
}

}  // namespace
}  // namespace bess
