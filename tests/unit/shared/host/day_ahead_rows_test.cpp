// Day-ahead answers in the format of servers, drawn from known days: no price differs from the
// day's, and only prices missing in the answer are left out.
#include "shared/host/day_ahead_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "shared/local_time.h"
#include "tests/support/market_zone.h"

namespace bess {
namespace {

constexpr std::int64_t kQuarter = 900;
constexpr std::int64_t kHour = 3'600;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string json_of(const std::vector<DayAheadRow>& rows) {
  std::string times, prices;
  for (const DayAheadRow& row : rows) {
    const char* const comma = times.empty() ? "" : ",";
    times += comma + std::to_string(row.utc_s);
    prices += comma + (std::isnan(row.eur_per_mwh) ? "null" : std::to_string(row.eur_per_mwh));
  }
  return R"({"unix_seconds":[)" + times + R"(],"price":[)" + prices + R"(],"unit":"EUR / MWh"})";
}

/// Two local days around a date, of quarter-hours that are drawn by hours, half hours or quarters.
struct DrawnDays : InMarketZone {
  DrawnDays(unsigned seed, int month, int day) : random(seed) {
    today = utc_from_local({2025, month, day, 0, 0, 0});
    tomorrow = utc_from_local({2025, month, day + 1, 0, 0, 0});
    end = utc_from_local({2025, month, day + 2, 0, 0, 0});
    for (std::int64_t t = today; t < end; t += kQuarter) {
      truth[t] = std::round(std::uniform_real_distribution(-5'000.0, 30'000.0)(random)) / 100;
    }
  }
  void hold(std::int64_t from, std::int64_t until, std::int64_t step) {
    for (std::int64_t t = from; t < until; t += kQuarter) truth[t] = truth[t - t % step];
  }
  [[nodiscard]] std::vector<DayAheadRow> rows(std::int64_t from, std::int64_t until,
                                              std::int64_t step) const {
    std::vector<DayAheadRow> all;
    for (std::int64_t t = from; t < until; t += step) all.push_back({t, truth.at(t)});
    return all;
  }
  static std::vector<DayAheadRow> merged(std::vector<DayAheadRow> all) {
    std::vector<DayAheadRow> kept;
    for (const DayAheadRow& row : all) {
      const bool is_run = !kept.empty() && row.eur_per_mwh == kept.back().eur_per_mwh;
      if (!is_run) kept.push_back(row);
    }
    return kept;
  }

  std::mt19937 random;
  std::int64_t today, tomorrow, end;
  std::map<std::int64_t, double> truth;
};

struct Laid {
  int sure = 0, assumed = 0, wrong = 0;
  std::vector<DayAheadDay> days;
};

Laid laid_out(const DrawnDays& days, const std::vector<DayAheadRow>& rows) {
  const DayAheadAnswer answer = parse_day_ahead_json(json_of(rows));
  EXPECT_EQ(answer.trouble, "");
  DayAheadLayout layout = lay_out_day_ahead(answer.rows);
  EXPECT_EQ(layout.trouble, "");
  Laid laid{.days = layout.days};
  for (const DayAheadDay& day : laid.days) {
    for (const DayAheadQuarterHour& q : day.quarter_hours) {
      ++(q.is_assumed ? laid.assumed : laid.sure);
      if (std::fabs(q.eur_per_mwh - days.truth.at(q.utc_s)) > 1e-6) ++laid.wrong;
    }
  }
  return laid;
}

class DayAhead : public testing::TestWithParam<unsigned> {
 protected:
  /// An ordinary day, and the two on which the clock changes.
  template <typename Try>
  void on_days(const Try& try_on) {
    for (const auto& [month, day] : {std::pair{6, 11}, {3, 29}, {10, 25}}) {
      DrawnDays days(GetParam(), month, day);
      SCOPED_TRACE(month);
      try_on(days, static_cast<int>((days.end - days.today) / kQuarter));
    }
  }
};

TEST_P(DayAhead, OfOneStepIsKnownInWhole) {
  on_days([](DrawnDays& days, int all) {
    for (const std::int64_t step : {kHour, 2 * kQuarter, kQuarter}) {
      DrawnDays held = days;
      held.hold(days.today, days.end, step);
      const Laid laid = laid_out(held, held.rows(days.today, days.end, step));
      EXPECT_EQ(laid.sure, all);
      EXPECT_EQ(laid.assumed + laid.wrong, 0);
    }
  });
}

TEST_P(DayAhead, OfHoursTodayAndQuarterHoursTomorrowOrWithinADay) {
  on_days([](DrawnDays& days, int all) {
    const std::int64_t noon = days.tomorrow + 12 * kHour;
    for (const std::int64_t change : {days.tomorrow, noon}) {
      days.hold(days.today, change, kHour);
      std::vector<DayAheadRow> rows = days.rows(days.today, change, kHour);
      for (const DayAheadRow& row : days.rows(change, days.end, kQuarter)) rows.push_back(row);
      const Laid laid = laid_out(days, rows);
      EXPECT_EQ(laid.sure, all);
      EXPECT_EQ(laid.wrong, 0);
    }
  });
}

/// Prices repeat in drawn places, also over midnight, and the server omits repetitions.
TEST_P(DayAhead, OfMergedRowsIsAssumedAndRight) {
  on_days([](DrawnDays& days, int all) {
    const std::int64_t eight_hours = 8 * kHour;
    const std::int64_t first =
        days.today + kQuarter * static_cast<std::int64_t>(days.random() % 32);
    for (std::int64_t slot = first; slot + eight_hours <= days.end; slot += eight_hours) {
      const std::int64_t from = slot + kQuarter * static_cast<std::int64_t>(days.random() % 8);
      const auto quarters = static_cast<std::int64_t>(5 + days.random() % 20);
      for (std::int64_t t = from; t < from + quarters * kQuarter; t += kQuarter) {
        days.truth[t] = days.truth[from];
      }
    }
    const Laid laid = laid_out(days, days.merged(days.rows(days.today, days.end, kQuarter)));
    EXPECT_EQ(laid.wrong, 0);
    EXPECT_GT(laid.assumed, 0);
    EXPECT_EQ(laid.sure + laid.assumed, all);
  });
}

TEST_P(DayAhead, WithoutPricesInDrawnPlacesAssumesNothing) {
  on_days([](DrawnDays& days, int all) {
    std::vector<DayAheadRow> rows = days.rows(days.today, days.end, kQuarter);
    int none = 0;
    for (DayAheadRow& row : rows) {
      if (days.random() % 4 != 0) continue;
      row.eur_per_mwh = kNone;
      ++none;
    }
    const Laid laid = laid_out(days, rows);
    EXPECT_EQ(laid.sure, all - none);
    EXPECT_EQ(laid.assumed + laid.wrong, 0);
  });
}

TEST_P(DayAhead, InAnyOrderIsTheSame) {
  on_days([](DrawnDays& days, int all) {
    std::vector<DayAheadRow> rows = days.rows(days.today, days.end, kQuarter);
    std::ranges::shuffle(rows, days.random);
    const Laid laid = laid_out(days, rows);
    EXPECT_EQ(laid.sure, all);
    EXPECT_EQ(laid.wrong, 0);
  });
}

INSTANTIATE_TEST_SUITE_P(Drawn, DayAhead, testing::Values(5301U, 5302U, 5303U));

struct DayAheadRows : InMarketZone, testing::Test {};

TEST_F(DayAheadRows, AConstantDayIsNoResult) {
  DrawnDays days(5304, 6, 11);
  for (std::int64_t t = days.tomorrow; t < days.end; t += kQuarter) days.truth[t] = 0;
  for (const std::int64_t step : {kHour, kQuarter}) {
    days.hold(days.today, days.tomorrow, step);
    const Laid laid = laid_out(days, days.rows(days.today, days.end, step));
    ASSERT_EQ(laid.days.size(), 2U);
    EXPECT_FALSE(laid.days[0].is_constant());
    EXPECT_TRUE(laid.days[1].is_constant());
  }
}

TEST_F(DayAheadRows, InvalidPricesAreOmittedAndInvalidAnswersReported) {
  const DayAheadAnswer nan = parse_day_ahead_json(
      R"({"unix_seconds":[1749600000,"x",1749600900,1749601800],"price":[NaN,2,"3",null]})");
  EXPECT_EQ(nan.trouble, "");
  EXPECT_EQ(nan.passed_over, 1);
  ASSERT_EQ(nan.rows.size(), 3U);
  for (const DayAheadRow& row : nan.rows) EXPECT_TRUE(std::isnan(row.eur_per_mwh));
  for (const char* const bad :
       {"", "[]", "{", R"({"unix_seconds":[1],"price":[1,2]})",
        R"({"unix_seconds":[1],"unix_seconds":[2],"price":[1]})",
        R"({"unix_seconds":[1749600000],"price":[1],"unit":"EUR / kWh"})"}) {
    EXPECT_NE(parse_day_ahead_json(bad).trouble, "") << bad;
  }
  EXPECT_NE(lay_out_day_ahead({{.utc_s = 1'749'600'060, .eur_per_mwh = 1}}).trouble, "");
  const DayAheadLayout twice = lay_out_day_ahead({{1'749'600'000, 1}, {1'749'600'000, 2}});
  EXPECT_EQ(twice.contradiction_utc_s, 1'749'600'000);
  EXPECT_TRUE(is_day_ahead_sentinel(-999));
  EXPECT_FALSE(is_day_ahead_sentinel(-500));
}

TEST_F(DayAheadRows, ALongHoleIsAHole) {
  DrawnDays days(5305, 6, 11);
  std::vector<DayAheadRow> rows = days.rows(days.today, days.tomorrow, kQuarter);
  std::erase_if(rows, [&](const DayAheadRow& row) {
    return row.utc_s > days.today + 4 * kHour && row.utc_s < days.today + 12 * kHour;
  });
  const Laid laid = laid_out(days, rows);
  EXPECT_EQ(laid.assumed, 0);
  EXPECT_EQ(laid.sure, 96 - 31);
}

}  // namespace
}  // namespace bess
