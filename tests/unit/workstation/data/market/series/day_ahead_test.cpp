// Day-ahead file: days of 92 and 100 quarter-hours, and what is known of it when.
#include "workstation/data/market/series/day_ahead.h"

#include <gmock/gmock.h>

#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {
namespace {

constexpr const char* kDayAheadHeader =
    "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n";

/// Quarter-hours of the local days [from, until), each priced by its place in the series.
DayAheadSeries days_of_prices(const LocalDate& from, const LocalDate& until) {
  DayAheadSeries series;
  const std::int64_t end = local_midnight_utc_s(until);
  for (std::int64_t utc_s = local_midnight_utc_s(from); utc_s < end; utc_s += 900) {
    const double price = 50 + 0.25 * static_cast<double>(series.size() % 1'000);
    EXPECT_TRUE(append_day_ahead(series, {utc_s, price, 15}));
  }
  return series;
}

TEST(DayAhead, ReadsBackFromItsFileToTheBit) {
  DayAheadSeries series = days_of_prices({2025, 6, 1}, {2025, 6, 3});
  series.eur_per_mwh[5] = kNotPublished;
  series.eur_per_mwh[6] = -12.345678901;
  series.resolution_min[7] = 60;
  series.published_utc_s[8] = utc_of("2025-05-31T11:47:00Z");
  const std::string text = format_day_ahead_csv(series, "by hand\nof a test");
  EXPECT_TRUE(is_day_ahead_csv(text));
  const DayAheadSeries read = parse_day_ahead_csv(text, "day.csv");
  ASSERT_EQ(read.size(), series.size());
  EXPECT_EQ(read.start_utc_s, series.start_utc_s);
  EXPECT_TRUE(std::isnan(read.eur_per_mwh[5]));
  EXPECT_EQ(read.eur_per_mwh[6], -12.345678901);
  EXPECT_EQ(read.resolution_min[7], 60);
  EXPECT_EQ(read.published_utc_s[8], series.published_utc_s[8]);
  EXPECT_EQ(format_day_ahead_csv(read, "by hand\nof a test"), text);
}

TEST(DayAhead, DamagedRowsAreReportedByLine) {
  const auto error_of = [](const std::string& rows) {
    return user_error_of([&] { parse_day_ahead_csv(kDayAheadHeader + rows, "day.csv"); });
  };
  const std::string good = "2025-06-01T10:00:00Z,41.5,60,\n";
  const std::pair<std::string, const char*> cases[] = {
      {"2025-06-01T10:15:00Z,41.5,60\n", "day.csv:3"},
      {"2025-06-01T10:15:00Z,41.5,60,,\n", "day.csv:3"},
      {"2025-06-01T10:20:00Z,41.5,60,\n", "day.csv:3"},
      {"2025-06-01T10:15:00,41.5,60,\n", "day.csv:3 UTC"},
      {"2025-06-01T10:15:00Z,nan,60,\n", "day.csv:3"},
      {"2025-06-01T10:15:00Z,1e999,60,\n", "day.csv:3"},
      {"2025-06-01T10:15:00Z,4x,60,\n", "day.csv:3"},
      {"2025-06-01T10:15:00Z,41.5,7,\n", "day.csv:3 15 30 60"},
      {"2025-06-01T10:15:00Z,41.5,60,noon\n", "day.csv:3"},
      {good, "day.csv:3"},
      {"2099-06-01T10:15:00Z,41.5,60,\n", "day.csv:3"}};
  for (const auto& [row, names] : cases) EXPECT_THAT(error_of(good + row), Names(names)) << row;
  EXPECT_THAT(error_of(""), Names("day.csv"));
  EXPECT_THAT(user_error_of([] { parse_day_ahead_csv("minute_utc,a,b\n", "m.csv"); }),
              Names("m.csv prices import --day-ahead"));
}

TEST(DayAhead, DaysOfClockChangesHave92And100QuarterHours) {
  EXPECT_EQ(days_of_prices({2025, 3, 30}, {2025, 3, 31}).size(), 92u);
  EXPECT_EQ(days_of_prices({2024, 10, 27}, {2024, 10, 28}).size(), 100u);
  DayAheadSeries series = days_of_prices({2025, 3, 29}, {2025, 4, 1});
  EXPECT_TRUE(incomplete_days(series).empty());
  series.eur_per_mwh[96 + 10] = kNotPublished;
  const std::vector<IncompleteDay> incomplete = incomplete_days(series);
  ASSERT_EQ(incomplete.size(), 1u);
  EXPECT_EQ(incomplete[0].date, "2025-03-30");
  EXPECT_EQ(incomplete[0].prices, 91u);
  EXPECT_EQ(incomplete[0].quarter_hours, 92u);
}

TEST(DayAhead, IsKnownFromOneOClockOfTheDayBefore) {
  const DayAheadPublication known(days_of_prices({2025, 6, 1}, {2025, 6, 4}));
  const std::int64_t delivery = utc_of("2025-06-02T10:00:00Z");
  EXPECT_TRUE(std::isnan(known.known_eur_per_mwh(delivery, utc_of("2025-06-01T10:59:00Z"))));
  EXPECT_FALSE(std::isnan(known.known_eur_per_mwh(delivery, utc_of("2025-06-01T11:00:00Z"))));
  EXPECT_FALSE(std::isnan(known.known_eur_per_mwh(delivery, utc_of("2025-06-01T11:01:00Z"))));
  // The whole local day, from midnight to midnight, and nothing of the next one.
  const std::int64_t one_o_clock = utc_of("2025-06-01T11:00:00Z");
  EXPECT_FALSE(std::isnan(known.known_eur_per_mwh(utc_of("2025-06-02T21:45:00Z"), one_o_clock)));
  EXPECT_TRUE(std::isnan(known.known_eur_per_mwh(utc_of("2025-06-02T22:00:00Z"), one_o_clock)));
  EXPECT_EQ(known.next_known_utc_s(delivery, delivery + 3'600, utc_of("2025-06-01T08:00:00Z")),
            one_o_clock);
  // Another hour, and the hour of winter time.
  const DayAheadPublication later(days_of_prices({2025, 1, 1}, {2025, 1, 3}), 14 * 60 + 30);
  const std::int64_t winter = utc_of("2025-01-02T10:00:00Z");
  EXPECT_TRUE(std::isnan(later.known_eur_per_mwh(winter, utc_of("2025-01-01T13:29:59Z"))));
  EXPECT_FALSE(std::isnan(later.known_eur_per_mwh(winter, utc_of("2025-01-01T13:30:00Z"))));
}

TEST(DayAhead, ALaterPublicationIsAcceptedAndAnEarlierOneIsNot) {
  DayAheadSeries series = days_of_prices({2025, 6, 1}, {2025, 6, 2});
  series.published_utc_s[40] = utc_of("2025-05-31T12:10:00Z");
  series.published_utc_s[41] = utc_of("2025-05-30T06:00:00Z");
  const DayAheadPublication known(series);
  const std::int64_t late = series.utc_s(40);
  EXPECT_TRUE(std::isnan(known.known_eur_per_mwh(late, utc_of("2025-05-31T12:09:00Z"))));
  EXPECT_FALSE(std::isnan(known.known_eur_per_mwh(late, utc_of("2025-05-31T12:10:00Z"))));
  const std::int64_t early = series.utc_s(41);
  EXPECT_TRUE(std::isnan(known.known_eur_per_mwh(early, utc_of("2025-05-31T10:59:00Z"))));
  EXPECT_FALSE(std::isnan(known.known_eur_per_mwh(early, utc_of("2025-05-31T11:00:00Z"))));
  EXPECT_TRUE(std::isnan(known.known_eur_per_mwh(series.end_utc_s(), series.end_utc_s())));
}

/// Names of the findings.
std::vector<std::string> names_of(const std::vector<Finding>& findings) {
  std::vector<std::string> names;
  for (const Finding& finding : findings) names.emplace_back(finding.name);
  return names;
}

TEST(DayAheadPlausibility, RealPricesHaveNoFindingAndMistakesHaveTheirs) {
  using testing::ElementsAre;
  const DayAheadSeries honest = days_of_prices({2025, 6, 1}, {2025, 6, 8});
  EXPECT_THAT(names_of(implausible_day_ahead(honest)), ElementsAre());
  DayAheadSeries bad = honest;
  bad.eur_per_mwh[7] = -9'999;
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("sentinel", "unusual-price"));
  bad = honest;
  bad.eur_per_mwh[7] = 2e5;
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("price-range"));
  bad = honest;
  for (double& price : bad.eur_per_mwh) price /= 1'000;
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("price-unit"));
  bad = honest;
  bad.eur_per_mwh.assign(bad.size(), 40);
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("constant"));
  bad = honest;
  for (std::size_t q = 96; q < 192; ++q) bad.eur_per_mwh[q] = bad.eur_per_mwh[q - 96];
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("repeated-day"));
  bad = honest;
  bad.eur_per_mwh[100] = kNotPublished;
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), ElementsAre("gaps"));
  bad = honest;
  bad.start_utc_s -= std::int64_t{60} * 366 * 86'400;
  EXPECT_THAT(names_of(implausible_day_ahead(bad)), testing::Contains("dates"));
}

struct SimulatedYear {
  DayAheadSeries day_ahead;
  MinuteSeries settled;
};

SimulatedYear simulated_year(std::uint64_t seed) {
  const auto quarter_hours = simulate_quarter_hours(
      {local_midnight_utc_s({2023, 1, 1}), local_midnight_utc_s({2024, 1, 1})}, seed);
  return {simulate_day_ahead(quarter_hours, seed), minutes_on_quarter_hours(quarter_hours, seed)};
}

// A file dated a day early would reveal tomorrow's prices today.
TEST(DayAheadPlausibility, AFileShiftedByADayIsCaught) {
  const SimulatedYear year = simulated_year(3);
  EXPECT_THAT(names_of(shifted_day_ahead(year.day_ahead, year.settled)), testing::IsEmpty());
  for (const int days : {1, -1}) {
    DayAheadSeries shifted = year.day_ahead;
    shifted.start_utc_s += days * 86'400;
    const std::vector<Finding> found = shifted_day_ahead(shifted, year.settled);
    ASSERT_EQ(names_of(found), std::vector<std::string>{"shifted-day"});
    EXPECT_TRUE(found[0].is_error);
  }
}

// Belgium, May 2024 to June 2025: correlation with settled prices 0.21 and 0.38 (of both years), of
// days' means 0.52 and 0.67; of prices an hour apart 0.94 and 0.92, a day apart 0.70 and 0.76.
TEST(SimulatedDayAhead, HasTheRealCorrelations) {
  const auto lagged = [](const std::vector<double>& x, std::size_t lag) {
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (std::size_t i = 0; i + lag < x.size(); ++i) {
      n += 1, a += x[i], b += x[i + lag], aa += x[i] * x[i];
      bb += x[i + lag] * x[i + lag], ab += x[i] * x[i + lag];
    }
    return (n * ab - a * b) / std::sqrt((n * aa - a * a) * (n * bb - b * b));
  };
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SimulatedYear year = simulated_year(seed);
    const double correlation = day_ahead_correlation(year.day_ahead, year.settled, 0);
    EXPECT_GT(correlation, 0.21) << seed;
    EXPECT_LT(correlation, 0.42) << seed;
    EXPECT_NEAR(lagged(year.day_ahead.eur_per_mwh, 4), 0.94, 0.03) << seed;
    EXPECT_NEAR(lagged(year.day_ahead.eur_per_mwh, 96), 0.70, 0.10) << seed;
    EXPECT_EQ(year.day_ahead.size(), 365u * 96);
    EXPECT_THAT(names_of(implausible_day_ahead(year.day_ahead)), testing::IsEmpty());
  }
  EXPECT_EQ(simulated_year(5).day_ahead.eur_per_mwh, simulated_year(5).day_ahead.eur_per_mwh);
}

}  // namespace
}  // namespace bess
