// Contents of an answer, its source, and the time of the request.
#include "edge/prices/fetch/day_ahead_feed.h"

#include <gtest/gtest.h>

#include <vector>

#include "shared/local_time.h"
#include "tests/support/market_zone.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

class Feed : public InMarketZone, public testing::Test {
 protected:
  Feed() { settings_.file = folder_.file("answer.json").c_str(); }
  Status ask(const std::string& answer) {
    EXPECT_EQ(settings_.file.view(), folder_.write("answer.json", answer));
    reply_ = ask_day_ahead(settings_, now_, [] { return false; });
    rows_.clear();
    for (const DayAheadDay& day : reply_.days) {
      rows_.insert(rows_.end(), day.quarter_hours.begin(), day.quarter_hours.end());
    }
    if (reply_.status != Status::kOk) return reply_.status;
    return DayAheadStore().take(reply_.days, now_);
  }
  std::int64_t now_ = utc_from_civil({2025, 6, 11, 10, 0, 0});
  TemporaryFolder folder_;
  OutlookSettings settings_;
  DayAheadReply reply_;
  std::vector<DayAheadQuarterHour> rows_;
};

TEST_F(Feed, TakesListsSideBySide) {
  ASSERT_EQ(ask(R"({"license_info":"x","unix_seconds":[1749600000,1749600900,1749601800],
                    "price":[12.345,null,-500.01],"unit":"EUR/MWh","deprecated":false})"),
            Status::kOk);
  ASSERT_EQ(rows_.size(), 2U);
  EXPECT_EQ(rows_[0].eur_per_mwh, 12.345);
  EXPECT_EQ(rows_[1].utc_s, 1'749'601'800);
  EXPECT_EQ(rows_[1].eur_per_mwh, -500.01);
}

TEST_F(Feed, TakesRows) {
  settings_.fields = {.rows = "data.rows", .time = "start", .price = "eur"};
  ASSERT_EQ(ask(R"({"data":{"rows":[{"start":"2025-06-11T02:00:00+02:00","eur":41.5}]}})"),
            Status::kOk);
  ASSERT_EQ(rows_.size(), 1U);
  EXPECT_EQ(rows_[0].utc_s, utc_from_civil({2025, 6, 11, 0, 0, 0}));
}

TEST_F(Feed, WhatIsNoAnswerIsRefused) {
  for (const char* answer : {"<html><body>Bad gateway</body></html>", "", "{}",
                             R"({"unix_seconds":[1749600000],"price":[1,2]})",
                             R"({"unix_seconds":[1749600000],"unix_seconds":[1],"price":[1]})",
                             R"({"unix_seconds":[1749600000],"price":[1]} trailing)",
                             R"({"unix_seconds":[1749600000],"price":[1)"}) {
    EXPECT_EQ(ask(answer), Status::kMalformed) << answer;
  }
  for (const char* answer : {R"({"unix_seconds":[1749600000],"price":[null]})",
                             R"({"unix_seconds":[1749600000],"price":[100000.02]})",
                             R"({"unix_seconds":[],"price":[]})"}) {
    EXPECT_EQ(ask(answer), Status::kNoRow) << answer;
  }
}

TEST_F(Feed, OfManyDaysThoseAroundNowCountAndLargeFilesDoNot) {
  std::string times;
  std::string prices;
  for (int i = 0; i < 500; ++i) {
    times += (i > 0 ? "," : "") + std::to_string(1'749'600'000 + 900 * i);
    prices += (i > 0 ? "," : "") + std::to_string(i % 97);
  }
  EXPECT_EQ(ask(R"({"unix_seconds":[)" + times + R"(],"price":[)" + prices + "]}"), Status::kOk);
  EXPECT_EQ(ask(std::string(400'000, ' ')), Status::kTooLarge);
}

TEST_F(Feed, NoFileIsNoConnection) {
  settings_.file = folder_.file("nothing").c_str();
  EXPECT_EQ(ask_day_ahead(settings_, now_, [] { return false; }).status, Status::kNotConnected);
  EXPECT_NE(day_ahead_status_text(Status::kNotConnected, settings_).find("[outlook] file"),
            std::string_view::npos);
  settings_.file = {};
  EXPECT_NE(day_ahead_status_text(Status::kNotConnected, settings_).find("url"),
            std::string_view::npos);
}

TEST_F(Feed, TheUrlNamesLocalDates) {
  const OutlookDays days = outlook_days_around(utc_from_civil({2025, 12, 31, 23, 30, 0}));
  EXPECT_EQ(day_ahead_url("http://h/p?a={today}&b={tomorrow}&{x}", days),
            "http://h/p?a=2026-01-01&b=2026-01-02&{x}");
}

class Schedule : public Feed {
 protected:
  static std::int64_t local(int hour, int minute) {
    return utc_from_local({2025, 6, 11, hour, minute, 0});
  }
  void know_until(std::int64_t until) {
    std::vector<DayAheadRow> rows;
    for (std::int64_t t = outlook_days_around(now_).today_utc_s; t < until; t += 900) {
      rows.push_back({t, static_cast<double>(t / 900 % 97)});
    }
    ASSERT_EQ(store_.take(lay_out_day_ahead(rows).days, local(0, 0)), Status::kOk);
  }
  [[nodiscard]] std::int64_t next(std::int64_t now, std::int64_t last, int tries) const {
    return next_ask_utc_s(store_, settings_, now, last, tries);
  }
  DayAheadStore store_;
};

TEST_F(Schedule, FetchesTodayImmediatelyThenTomorrowAtTenToOne) {
  EXPECT_LE(next(local(3, 0), 0, 0), local(3, 0));
  know_until(outlook_days_around(now_).tomorrow_utc_s);
  EXPECT_EQ(next(local(3, 0), local(2, 0), 0), local(12, 50));
  settings_.ask_offset_s = 77;
  EXPECT_EQ(next(local(3, 0), local(2, 0), 0), local(12, 51) + 17);
  know_until(outlook_days_around(now_).end_utc_s);
  EXPECT_EQ(next(local(13, 0), local(12, 55), 0), local(12, 51) + 17 + 86'400);
}

TEST_F(Schedule, AsksAgainAfterAMinuteThenTwoToHalfAnHour) {
  know_until(outlook_days_around(now_).tomorrow_utc_s);
  const std::int64_t last = local(13, 0);
  const int pauses_s[] = {60, 60, 120, 240, 480, 960, 1'800, 1'800};
  for (int tries = 0; tries < 8; ++tries) {
    EXPECT_EQ(next(last, last, tries), last + pauses_s[tries]) << tries;
  }
  EXPECT_EQ(next(last, last, 1'000'000), last + 1'800);
  EXPECT_EQ(next_ask_utc_s(store_, settings_, last, last, 1, 3'600), last + 3'600);
}

TEST_F(Schedule, AfterTenToOneItIsDueUntilTomorrowIsWhole) {
  know_until(outlook_days_around(now_).tomorrow_utc_s);
  EXPECT_GT(due_utc_s(store_, settings_, local(12, 49)), local(12, 49));
  EXPECT_LE(due_utc_s(store_, settings_, local(12, 50)), local(12, 50));
  know_until(outlook_days_around(now_).end_utc_s);
  EXPECT_GT(due_utc_s(store_, settings_, local(12, 58)), local(12, 58));
}

TEST_F(Schedule, AClockThatWasSteppedBackKeepsItFromNothing) {
  EXPECT_LE(next(local(3, 0), local(20, 0), 5), local(3, 0));
}

}  // namespace
}  // namespace bess
