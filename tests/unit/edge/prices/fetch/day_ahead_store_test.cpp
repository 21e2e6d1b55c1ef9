// Answers of any source: what is stored, and what is known when.
#include "edge/prices/fetch/day_ahead_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/market_zone.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

constexpr std::int64_t kHour = 3'600;

/// Prices of quarter-hours that differ from each other and between days.
std::int32_t price_at(std::int64_t utc_s) {
  return static_cast<std::int32_t>(utc_s / kSecondsPerQuarterHour * 7'919 % 20'011) - 4'000;
}

std::vector<DayAheadRow> rows_of(std::int64_t from, std::int64_t until,
                                 std::int64_t step = kSecondsPerQuarterHour) {
  std::vector<DayAheadRow> rows;
  for (std::int64_t t = from; t < until; t += step) rows.push_back({t, price_at(t) / 100.0});
  return rows;
}

class Store : public InMarketZone, public testing::Test {
 protected:
  static std::int64_t local(int month, int day, int hour, int minute = 0) {
    return utc_from_local({2025, month, day, hour, minute, 0});
  }
  /// An answer of today and tomorrow.
  std::vector<DayAheadRow> both() const { return rows_of(days_.today_utc_s, days_.end_utc_s); }
  Status take(const std::vector<DayAheadRow>& rows, std::int64_t at) {
    return store_.take(lay_out_day_ahead(rows).days, at);
  }
  [[nodiscard]] int known(std::int64_t from, std::int64_t until, std::int64_t at) const {
    const OutlookDays days = store_.days_at(at);
    int count = 0;
    for (std::int64_t t = from; t < until; t += kSecondsPerQuarterHour) {
      const std::int32_t centi = days.day_ahead_centi[days.index_of(t)];
      if (centi != kDayAheadUnknown) ++count;
      if (centi != kDayAheadUnknown && centi != price_at(t)) return -1;
    }
    return count;
  }
  [[nodiscard]] int known_tomorrow(std::int64_t at) const {
    return known(days_.tomorrow_utc_s, days_.end_utc_s, at);
  }

  std::int64_t now_ = local(6, 11, 12, 58);
  OutlookDays days_ = outlook_days_around(now_);
  DayAheadStore store_;
};

TEST_F(Store, TomorrowIsKnownAtOneAndNotBefore) {
  ASSERT_EQ(take(both(), now_), Status::kOk);
  EXPECT_EQ(known(days_.today_utc_s, days_.tomorrow_utc_s, now_), 96);
  EXPECT_EQ(known_tomorrow(local(6, 11, 12, 59)), 0);
  EXPECT_EQ(known_tomorrow(local(6, 11, 13, 0)), 96);
  EXPECT_EQ(known_tomorrow(local(6, 11, 13, 1)), 96);
}

TEST_F(Store, NothingIsKnownBeforeItCame) {
  const std::int64_t late = local(6, 11, 15, 7);
  ASSERT_EQ(take(both(), late), Status::kOk);
  EXPECT_EQ(known_tomorrow(late - 1), 0);
  EXPECT_EQ(known(days_.today_utc_s, days_.tomorrow_utc_s, late - 1), 0);
  EXPECT_EQ(known_tomorrow(late), 96);
}

TEST_F(Store, DaysOfTheClocksChangeHave92And100) {
  for (const auto& [month, day, count] : {std::tuple{3, 29, 92}, std::tuple{10, 25, 100}}) {
    DayAheadStore store;
    const std::int64_t at = local(month, day, 13);
    const OutlookDays days = outlook_days_around(at);
    ASSERT_EQ(store.take(lay_out_day_ahead(rows_of(days.today_utc_s, days.end_utc_s)).days, at),
              Status::kOk);
    EXPECT_EQ((days.end_utc_s - days.tomorrow_utc_s) / kSecondsPerQuarterHour, count);
    EXPECT_TRUE(store.has_all(days.today_utc_s, days.end_utc_s, at));
  }
}

TEST_F(Store, HoursCountForTheirQuarterHours) {
  ASSERT_EQ(take(rows_of(days_.today_utc_s, days_.end_utc_s, kHour), now_), Status::kOk);
  const OutlookDays days = store_.days_at(now_);
  for (std::int64_t t = days_.today_utc_s; t < days_.tomorrow_utc_s; t += kSecondsPerQuarterHour) {
    EXPECT_EQ(days.day_ahead_centi[days.index_of(t)], price_at(t - t % kHour));
  }
}

TEST_F(Store, ADayByHalfIsKeptAndFilledUpLater) {
  ASSERT_EQ(take(rows_of(days_.today_utc_s, days_.tomorrow_utc_s + 12 * kHour), now_), Status::kOk);
  const std::int64_t later = local(6, 11, 14);
  EXPECT_EQ(known_tomorrow(later), 48);
  EXPECT_FALSE(store_.has_all(days_.tomorrow_utc_s, days_.end_utc_s, later));
  ASSERT_EQ(take(both(), later), Status::kOk);
  EXPECT_EQ(known_tomorrow(later), 96);
}

TEST_F(Store, AnAnswerWithNothingNewChangesNothing) {
  ASSERT_EQ(take(both(), now_), Status::kOk);
  EXPECT_EQ(store_.changes(), 192U);
  ASSERT_EQ(take(both(), now_ + 60), Status::kOk);
  EXPECT_EQ(store_.changes(), 192U);
}

TEST_F(Store, WhatIsNegativeOrExtremeIsAPrice) {
  std::vector<DayAheadRow> rows = both();
  rows[5].eur_per_mwh = -500;
  rows[6].eur_per_mwh = kPlausiblePriceMaxEurPerMwh;
  ASSERT_EQ(take(rows, now_), Status::kOk);
  const OutlookDays days = store_.days_at(now_);
  EXPECT_EQ(days.day_ahead_centi[days.index_of(rows[5].utc_s)], -50'000);
}

struct Spoilt {
  const char* name;
  std::function<void(std::vector<DayAheadRow>&)> spoil;
  Status status;
  int known_tomorrow;
};

class StoreOfToday : public Store, public testing::WithParamInterface<Spoilt> {};

/// Today is known, and a faulty answer of today and tomorrow arrives.
TEST_P(StoreOfToday, AnswersAsTheTableSays) {
  ASSERT_EQ(take(rows_of(days_.today_utc_s, days_.tomorrow_utc_s), days_.today_utc_s), Status::kOk);
  std::vector<DayAheadRow> rows = both();
  GetParam().spoil(rows);
  EXPECT_EQ(take(rows, now_), GetParam().status);
  EXPECT_EQ(known(days_.today_utc_s, days_.tomorrow_utc_s, now_), 96);
  EXPECT_EQ(known_tomorrow(local(6, 11, 13)), GetParam().known_tomorrow);
  // The next good one is accepted normally.
  EXPECT_EQ(take(both(), now_ + 600), Status::kOk);
  EXPECT_EQ(known_tomorrow(local(6, 11, 14)), 96);
}

std::vector<Spoilt> spoilt_answers() {
  using Rows = std::vector<DayAheadRow>;
  const auto each_row = [](const std::function<void(DayAheadRow&)>& change) {
    return [change](Rows& rows) { std::ranges::for_each(rows, change); };
  };
  const auto shift = [&](std::int64_t seconds) {
    return each_row([seconds](DayAheadRow& row) { row.utc_s += seconds; });
  };
  const auto prices_from = [](std::size_t first, std::size_t end, auto price) {
    return [=](Rows& rows) {
      for (std::size_t i = first; i < end; ++i) rows[i].eur_per_mwh = price(rows, i);
    };
  };
  return {
      {"shifted_by_an_hour", shift(kHour), Status::kImplausible, 0},
      {"shifted_back_by_an_hour", shift(-kHour), Status::kImplausible, 0},
      {"shifted_by_a_day", shift(24 * kHour), Status::kImplausible, 0},
      {"shifted_back_by_a_day", shift(-24 * kHour), Status::kImplausible, 0},
      {"of_another_year", shift(-365 * 24 * kHour), Status::kNoRow, 0},
      {"no_quarter_hours", shift(60), Status::kNoRow, 0},
      {"another_market", each_row([](DayAheadRow& row) { row.eur_per_mwh += 3.11; }),
       Status::kImplausible, 0},
      {"yesterdays_again",
       prices_from(96, 192, [](Rows& rows, std::size_t i) { return rows[i - 96].eur_per_mwh; }),
       Status::kImplausible, 0},
      {"falling_times", [](auto& rows) { std::swap(rows[3], rows[4]); }, Status::kOk, 96},
      {"zeros_until_the_auction", prices_from(96, 192, [](Rows&, std::size_t) { return 0; }),
       Status::kImplausible, 0},
      {"in_eur_per_kwh", each_row([](DayAheadRow& row) { row.eur_per_mwh /= 1'000; }),
       Status::kDoubtfulUnit, 0},
      {"tomorrow_in_eur_per_kwh",
       prices_from(96, 192, [](Rows& rows, std::size_t i) { return rows[i].eur_per_mwh / 1'000; }),
       Status::kDoubtfulUnit, 0},
      {"no_price_as_minus_999", prices_from(100, 110, [](Rows&, std::size_t) { return -999; }),
       Status::kOk, 86},
      {"doubles_that_agree", [](auto& rows) { rows.insert(rows.begin() + 100, rows[100]); },
       Status::kOk, 96},
      {"nothing", [](auto& rows) { rows.clear(); }, Status::kNoRow, 0},
  };
}

INSTANTIATE_TEST_SUITE_P(All, StoreOfToday, testing::ValuesIn(spoilt_answers()),
                         [](const auto& info) { return info.param.name; });

TEST_F(Store, MergedRowsAreAssumedFetchedAgainAndAcceptedWhenTheyStay) {
  std::vector<DayAheadRow> merged = both();
  std::erase_if(merged, [&](const DayAheadRow& row) {
    return row.utc_s > days_.tomorrow_utc_s + 2 * kHour &&
           row.utc_s < days_.tomorrow_utc_s + 5 * kHour;
  });
  const std::int64_t at_13 = local(6, 11, 13);
  ASSERT_EQ(take(merged, now_), Status::kOk);
  const OutlookDays days = store_.days_at(at_13);
  EXPECT_EQ(days.day_ahead_centi[days.index_of(days_.tomorrow_utc_s + 4 * kHour)],
            price_at(days_.tomorrow_utc_s + 2 * kHour));
  EXPECT_FALSE(store_.has_all(days_.tomorrow_utc_s, days_.end_utc_s, at_13));
  DayAheadStore other = store_;
  ASSERT_EQ(other.take(lay_out_day_ahead(merged).days, now_ + 3 * kHour), Status::kOk);
  EXPECT_TRUE(other.has_all(days_.tomorrow_utc_s, days_.end_utc_s, now_ + 3 * kHour));
  ASSERT_EQ(take(both(), now_ + 600), Status::kOk);
  EXPECT_EQ(known_tomorrow(now_ + 600), 96);
}

TEST_F(Store, WhatIsRepeatedForHoursReplacesWhatItContradicts) {
  std::vector<DayAheadRow> wrong = both();
  for (std::size_t i = 96; i < wrong.size(); ++i) wrong[i].eur_per_mwh += 3.11;
  ASSERT_EQ(take(wrong, now_), Status::kOk);
  EXPECT_EQ(take(both(), now_ + 600), Status::kImplausible);
  EXPECT_EQ(take(both(), now_ + 2 * kHour), Status::kImplausible);
  EXPECT_EQ(known_tomorrow(now_ + 2 * kHour), -1);
  EXPECT_EQ(take(both(), now_ + 600 + 3 * kHour), Status::kOk);
  EXPECT_EQ(known_tomorrow(now_ + 4 * kHour), 96);
}

TEST_F(Store, HoursTodayAndQuarterHoursTomorrow) {
  std::vector<DayAheadRow> rows = rows_of(days_.today_utc_s, days_.tomorrow_utc_s, kHour);
  for (const DayAheadRow& row : rows_of(days_.tomorrow_utc_s, days_.end_utc_s)) rows.push_back(row);
  ASSERT_EQ(take(rows, now_), Status::kOk);
  EXPECT_TRUE(store_.has_all(days_.today_utc_s, days_.end_utc_s, now_));
  EXPECT_EQ(known_tomorrow(local(6, 11, 13)), 96);
}

TEST_F(Store, WhatCameByAClockThatWasWrongIsUnknownAndComesAgain) {
  const std::int64_t wrong = now_ + 20 * kHour;
  ASSERT_EQ(take(both(), wrong), Status::kOk);
  EXPECT_EQ(known(days_.today_utc_s, days_.tomorrow_utc_s, now_), 0);
  EXPECT_FALSE(store_.has_all(days_.today_utc_s, days_.tomorrow_utc_s, now_));
  ASSERT_EQ(take(both(), now_), Status::kOk);
  EXPECT_EQ(known(days_.today_utc_s, days_.tomorrow_utc_s, now_), 96);
}

class KeptStore : public Store {
 protected:
  [[nodiscard]] std::string path() const { return folder_.file("day_ahead"); }
  TemporaryFolder folder_;
};

TEST_F(KeptStore, ReadsBackFromItsFileToTheSecond) {
  ASSERT_EQ(take(both(), now_), Status::kOk);
  ASSERT_TRUE(keep_day_ahead(path().c_str(), store_));
  DayAheadStore again;
  EXPECT_EQ(restore_day_ahead(path().c_str(), again), 192);
  for (const std::int64_t at : {now_ - 1, now_, local(6, 11, 13), local(6, 12, 9)}) {
    EXPECT_EQ(again.days_at(at), store_.days_at(at));
  }
}

TEST_F(KeptStore, OfADamagedFileNothingIsRestored) {
  EXPECT_EQ(restore_day_ahead(path().c_str(), store_), 0);
  ASSERT_EQ(take(both(), now_), Status::kOk);
  ASSERT_TRUE(keep_day_ahead(path().c_str(), store_));
  const std::string whole = text_of_file(path());
  for (std::size_t at = 3; at < whole.size(); at += 1'009) {
    std::string damaged = whole;
    damaged[at] = damaged[at] == '1' ? '2' : '1';
    ASSERT_EQ(folder_.write("day_ahead", damaged), path());
    DayAheadStore again;
    EXPECT_EQ(restore_day_ahead(path().c_str(), again), 0) << at;
    ASSERT_EQ(folder_.write("day_ahead", whole.substr(0, at)), path());
    EXPECT_EQ(restore_day_ahead(path().c_str(), again), 0) << at;
  }
}

}  // namespace
}  // namespace bess
