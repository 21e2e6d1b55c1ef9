// Implausible prices, and acceptance of real ones.
#include "workstation/data/market/series/plausibility.h"

#include <gmock/gmock.h>

#include "shared/host/file.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/price_cases.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> texts_of(const std::vector<Finding>& findings) {
  std::vector<std::string> names;
  for (const Finding& finding : findings)
    names.push_back(std::string(finding.name) + ": " + finding.what);
  return names;
}

MinuteSeries ordinary() { return parse_minute_csv(ordinary_text(), "ordinary"); }

TEST(Plausibility, RealPricesRaiseNothing) {
  EXPECT_THAT(texts_of(implausible(read_benchmark())), IsEmpty());
  EXPECT_THAT(texts_of(implausible(ordinary())), IsEmpty());
  EXPECT_THAT(texts_of(implausible(random_series("2023-01-01T00:00:00Z", 40'000, 7))), IsEmpty());
}

TEST(Plausibility, RealDownloadsRaiseNothing) {
  for (const char* name : {"elia_quarter_hour_2023-01_2023-05.csv.gz",
                           "elia_minute_2024-09-06.csv.gz", "elia_minute_2025-04-08.csv.gz",
                           "raw/ods047_head3000.csv.gz", "raw/ods161_2024-09-06.csv.gz",
                           "raw/ods161_2025-04-08.csv.gz", "benchmark_minutes_2023.csv.gz"}) {
    const JoinedMarket market = join_market(read_market_files({real_sample(name).string()}), name);
    EXPECT_THAT(texts_of(implausible(market.series)), IsEmpty()) << name;
  }
}

TEST(Plausibility, QuarterHoursOfALaterYearRaiseNothing) {
  const std::string name = "elia_quarter_hour_2024-05_2024-12.csv.gz";
  BESS_SKIP_WITHOUT(name);
  const JoinedMarket market = join_market(read_market_files({outside_sample(name).string()}), name);
  EXPECT_THAT(texts_of(implausible(market.series)), IsEmpty());
}

/// Belgium settled seven quarter-hours of 2025 at -999.
TEST(Plausibility, ASettledPriceOfMinus999IsOne) {
  BESS_SKIP_WITHOUT("elia_quarter_hour_2025-01_2025-06.csv.gz");
  const std::string path = outside_sample("elia_quarter_hour_2025-01_2025-06.csv.gz").string();
  const JoinedMarket market = join_market(read_market_files({path}), "2025");
  EXPECT_EQ(std::ranges::count(market.series.settled, -999.0), 3 * kMinutesPerQuarterHour);
  EXPECT_THAT(texts_of(implausible(market.series)), IsEmpty());
}

MinuteSeries with_settled(double eur_per_mwh, std::size_t quarter_hours) {
  MinuteSeries series = ordinary();
  for (std::size_t i = 0; i < quarter_hours; ++i) {
    std::fill_n(series.settled.begin() + static_cast<std::ptrdiff_t>(7 + 11 * i) * 15, 15,
                eur_per_mwh);
  }
  return series;
}

TEST(Plausibility, ExtremesThatMarketsHaveHadAreAcceptedAndReported) {
  for (const double price : {-999.0, 9'998.0, 15'000.0, -15'000.0}) {
    EXPECT_THAT(texts_of(implausible(with_settled(price, 1))), IsEmpty()) << price;
  }
  for (const double price : {25'907.54, -25'907.54, 99'999.0, -99'999.0, 100'000.0}) {
    const std::vector<Finding> findings = implausible(with_settled(price, 1));
    ASSERT_EQ(findings.size(), 1u) << price;
    EXPECT_EQ(findings[0].name, "unusual-price");
    EXPECT_FALSE(findings[0].is_error);
    EXPECT_THAT(findings[0].what, Names(fmt::format("{} 15000 15", price)));
  }
  for (const double price : {100'000.01, -1e6}) {
    const std::vector<Finding> findings = implausible(with_settled(price, 1));
    ASSERT_FALSE(findings.empty()) << price;
    EXPECT_EQ(findings[0].name, "price-range");
    EXPECT_TRUE(findings[0].is_error);
  }
}

/// Repeated -999 is an instrument's error value: reported, and still accepted.
TEST(Plausibility, ManyPossibleErrorValuesAreReportedAndAccepted) {
  EXPECT_THAT(texts_of(implausible(with_settled(-999, 2))), IsEmpty());
  const std::vector<Finding> findings = implausible(with_settled(-999, 8));
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].name, "sentinel");
  EXPECT_FALSE(findings[0].is_error);
  EXPECT_THAT(findings[0].what, Names("-999 2.8 %"));
}

TEST(Plausibility, GapsAreCounted) {
  MinuteSeries series = ordinary();
  const auto leave_out = [&series](std::size_t from, std::size_t count) {
    for (std::size_t m = from; m < from + count; ++m) {
      series.indicative[m] = series.settled[m] = std::nan("");
    }
  };
  leave_out(0, 90);  // an end is no gap
  leave_out(100, 5);
  EXPECT_THAT(implausible(series), IsEmpty());
  leave_out(1'000, 90);
  const std::vector<Finding> findings = implausible(series);
  ASSERT_EQ(findings.size(), 2u);  // of each column
  EXPECT_FALSE(findings[0].is_error);
  EXPECT_EQ(findings[0].name, "gaps");
  EXPECT_THAT(findings[0].what, Names("2 95 4320 90 2023-01-01T15:40:00Z 2023-01-01T17:10:00Z"));
}

TEST(Plausibility, APriceThatHangsIsNamed) {
  MinuteSeries series = ordinary();
  std::fill_n(series.indicative.begin() + 100, 1'500, 55.5);
  EXPECT_THAT(texts_of(implausible(series)), ElementsAre(Names("frozen 55.5 1500")));
}

TEST(Plausibility, AColumnThatIsTheOtherIsNamed) {
  MinuteSeries series = ordinary();
  series.indicative = series.settled;
  EXPECT_THAT(texts_of(implausible(series)), ElementsAre(Names("copied-column")));
}

TEST(Plausibility, AMissingLineEndIsAWarningUnlessTheRowIsWrong) {
  const std::string text = ordinary_text();
  const std::string unended = text.substr(0, text.size() - 1);
  EXPECT_THAT(implausible_end(text, parse_minute_csv(text, "f")), IsEmpty());
  const std::vector<Finding> whole = implausible_end(unended, parse_minute_csv(unended, "f"));
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_FALSE(whole[0].is_error);
  const std::string cut = text.substr(0, text.rfind(',') + 1);
  EXPECT_TRUE(implausible_end(cut, parse_minute_csv(cut, "f")).at(0).is_error);
}

TEST(Plausibility, RowsAreFoundInAnyCsv) {
  EXPECT_EQ(row_of_time("a;b\n2023-01-01T00:00:00+01:00;5\n", utc_of("2022-12-31T23:00:00Z")), 2u);
  EXPECT_EQ(row_of_time("# 2023-01-01T00:00:00Z\r\nb\r\n5,2023-01-01T00:00:00Z\r\n",
                        utc_of("2023-01-01T00:00:00Z")),
            3u);
  EXPECT_EQ(row_of_time("{}", 0), 0u);
}

TEST(Plausibility, NamesOfWhatIsAcceptedAreChecked) {
  EXPECT_TRUE(AcceptedFindings("gaps,overlap").accepts("overlap"));
  EXPECT_FALSE(AcceptedFindings("gaps").accepts("overlap"));
  EXPECT_FALSE(AcceptedFindings("").accepts("gaps"));
  EXPECT_THAT(user_error_of([] { AcceptedFindings("gaps,,overlap"); }), Names("--accept \"\""));
}

}  // namespace
}  // namespace bess
