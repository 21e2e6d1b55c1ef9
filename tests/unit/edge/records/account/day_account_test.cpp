// Daily summary line: money computed by hand, and its numbers.
#include "edge/records/account/day_accounts.h"

#include <gmock/gmock.h>

#include "shared/local_time.h"
#include "tests/support/tokens.h"

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
  DayAccounts day_accounts(kDay, kDay, terms);
  std::int64_t utc_s = local_day_start_utc_s(kDay) + 12 * 3'600;
  for (CycleRecord& record : records) {
    record.utc_s = utc_s += kSecondsPerStep;
    record.price.minute_utc_s = utc_s - 60;
    day_accounts.add(record);
  }
  return day_accounts.accounts().at(0);
}

/// Half an hour at 4 kW in at -50, half an hour out at 200 EUR/MWh: 2 kWh each, 0.10 + 0.40 EUR.
TEST(DayAccount, CountsMoneyAsAMeterWould) {
  std::vector<CycleRecord> records(15, cycle(4'000, -5'000));
  records.insert(records.end(), 15, cycle(-4'000, 20'000));
  const DayAccount day = account_of(records);
  EXPECT_NEAR(day.charged_kwh(), 2, 1e-9);
  EXPECT_NEAR(day.discharged_kwh(), 2, 1e-9);
  EXPECT_NEAR(day.exchanged.money.earned_eur, 0.10 + 0.40, 1e-9);
  EXPECT_EQ(day.cycles, 30);
  EXPECT_EQ(day.interventions(), 0);
}

TEST(DayAccount, TheLineHasItsNumbers) {
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
  EXPECT_THAT(account_of(records).line(),
              Names("2023-11-26: +0.40 0 3 0.0 2.0 kWh 0.25 5 link 1 soc_empty 3 held 1"));
}

/// An order is in force from its write, which the price's age shows; a release is none.
TEST(DayAccount, ASampleIsARecordsOwn) {
  CycleRecord record = cycle(-7, 100);
  ExchangeSample taken;
  record.price.minute_utc_s = -60;
  record.price_age_s = 5;
  record.written = true;
  ASSERT_TRUE(sample_of(record, taken));
  EXPECT_EQ(taken.power_w, -7);
  EXPECT_TRUE(taken.is_ordered);
  EXPECT_NEAR(taken.written_after_s, 5.5, 1e-6);
  record.mode = Mode::kSafe;
  ASSERT_TRUE(sample_of(record, taken));
  EXPECT_FALSE(taken.is_ordered);
  record.has_measurement = false;
  EXPECT_FALSE(sample_of(record, taken));
}

/// From midnight to noon, and three more ticks without a record; a clock step backwards omits none.
TEST(DayAccount, TicksWithoutARecordCount) {
  set_market_time_zone();
  const MoneyTerms terms;
  DayAccounts day_accounts(kDay, kDay, terms);
  const std::int64_t noon_utc_s = local_day_start_utc_s(kDay) + 12 * 3'600;
  for (const int tick : {-400, 0, 1, 5, 2}) {  // the first belongs to the previous day
    CycleRecord record = cycle(0, 0, Reason::kPriceAge);
    record.mode = Mode::kHolding;
    record.utc_s = noon_utc_s + tick * kSecondsPerStep;
    day_accounts.add(record);
  }
  const DayAccount day = day_accounts.accounts().at(0);
  EXPECT_EQ(day.cycles, 4);
  EXPECT_EQ(day.missing_cycles, 360 + 3);
  EXPECT_EQ(day.driven_share(), 0);
  EXPECT_EQ(day.not_driven_by_reason[static_cast<std::size_t>(Reason::kPriceAge)], 4);
}

TEST(DayAccount, TheThroughputOfAnotherDayIsNotThisDays) {
  DayAccount day{.local_day = kDay};
  CycleRecord first = cycle(0, 0);
  first.throughput = {.local_day = kDay - 1, .soc_moved_e4 = 20'000};
  day.add(first);
  EXPECT_EQ(day.full_cycles(), 0);
  EXPECT_EQ(day.cycles, 1);
}

}  // namespace
}  // namespace bess
