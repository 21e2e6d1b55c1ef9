// The daily line: money by hand, and its text to the letter.
#include "edge/account/day_account.h"

#include <gtest/gtest.h>

#include "edge/account/account_days.h"

#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int32_t kDay = 20'231'126;

CycleRecord cycle(std::int32_t power_w, std::int32_t price_centi,
                  Reason reason = Reason::kStudent) {
  CycleRecord record;
  record.mode = Mode::kRunning;
  record.reason = reason;
  record.has_measurement = true;
  record.measurement.power_w = power_w;
  record.price.has_row = true;
  record.price.price_centi_eur_per_mwh = price_centi;
  return record;
}

/// Of records two minutes apart, from noon of the day.
DayAccount account_of(std::vector<CycleRecord> records, const MoneyTerms& terms = {}) {
  set_market_time_zone();
  DayBook book(kDay, kDay, terms);
  std::int64_t utc_s = DayAccount(kDay).start_utc_s() + 12 * 3'600;
  for (CycleRecord& record : records) {
    record.utc_s = utc_s += kSecondsPerStep;
    record.price.minute_utc_s = utc_s - 60;
    book.add(record);
  }
  return book.accounts().at(0);
}

/// Half an hour at 4 kW in at -50, half an hour out at 200 EUR/MWh: 2 kWh each, 0.10 + 0.40 EUR.
TEST(DayAccount, CountsMoneyAsAMeterWould) {
  std::vector<CycleRecord> records(15, cycle(4'000, -5'000));
  records.insert(records.end(), 15, cycle(-4'000, 20'000));
  const DayAccount day = account_of(records);
  EXPECT_NEAR(day.charged_kwh(), 2, 1e-9);
  EXPECT_NEAR(day.discharged_kwh(), 2, 1e-9);
  EXPECT_NEAR(day.earned_eur(), 0.10 + 0.40, 1e-9);
  EXPECT_EQ(day.cycles(), 30);
  EXPECT_EQ(day.interventions(), 0);
}

TEST(DayAccount, TheLineIsThis) {
  std::vector<CycleRecord> records(15, cycle(-4'000, 20'000));
  records.insert(records.end(), 3, cycle(0, 0, Reason::kSocEmpty));
  CycleRecord blind = cycle(0, 0, Reason::kLink);
  blind.has_measurement = false;
  records.push_back(blind);
  CycleRecord last = cycle(0, 0, Reason::kHeld);
  last.throughput = {.local_day = kDay, .soc_moved_e4 = 5'000};
  records.push_back(last);
  CycleRecord stop = last;
  stop.mode = Mode::kStopping;
  records.push_back(stop);
  EXPECT_EQ(
      account_of(records).line(),
      "2023-11-26: +0.40 EUR (0 of 3 quarter-hours at the settled price, an estimate in the "
      "others; "
      "no fees), charged 0.0 kWh, discharged 2.0 kWh, 0.25 full cycles, 5 interventions (link 1, "
      "soc_empty 3, held 1)");
}

/// 2 kWh in at 50 EUR/MWh and 45 a MWh.
TEST(DayAccount, TheLineTellsTheFees) {
  MoneyTerms terms{.capacity_wh = 8'000};
  terms.contract.costs.import_adder_eur_per_mwh = 45;
  const DayAccount day = account_of(std::vector<CycleRecord>(15, cycle(4'000, 5'000)), terms);
  EXPECT_NEAR(day.money().contract_eur, 0.09, 1e-9);
  EXPECT_NEAR(day.money().net_eur(), -0.19, 1e-9);
  EXPECT_NE(day.line().find("-0.10 EUR (0 of 2 quarter-hours at the settled price, an estimate in "
                            "the others; 0.09 EUR of fees not taken off)"),
            std::string::npos)
      << day.line();
}

TEST(DayAccount, TheThroughputOfAnotherDayIsNotThisDays) {
  DayAccount day(kDay);
  CycleRecord first = cycle(0, 0);
  first.throughput = {.local_day = kDay - 1, .soc_moved_e4 = 20'000};
  day.add(first);
  EXPECT_EQ(day.full_cycles(), 0);
  EXPECT_FALSE(day.is_empty());
  EXPECT_TRUE(DayAccount(kDay).is_empty());
}

/// In summer, in winter, and on the two days of the clock changes.
TEST(DayAccount, BeginsAtLocalMidnight) {
  set_market_time_zone();
  const auto starts = [](std::int32_t day) {
    return std::string(utc_text(DayAccount(day).start_utc_s()).view());
  };
  EXPECT_EQ(starts(20'230'115), "2023-01-14T23:00:00Z");
  EXPECT_EQ(starts(20'230'326), "2023-03-25T23:00:00Z");
  EXPECT_EQ(starts(20'230'327), "2023-03-26T22:00:00Z");
  EXPECT_EQ(starts(20'230'701), "2023-06-30T22:00:00Z");
  EXPECT_EQ(starts(20'231'029), "2023-10-28T22:00:00Z");
  EXPECT_EQ(starts(20'231'030), "2023-10-29T23:00:00Z");
  EXPECT_EQ(starts(20'240'101), "2023-12-31T23:00:00Z");
}

}  // namespace
}  // namespace bess
