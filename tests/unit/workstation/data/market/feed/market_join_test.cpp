// Joining rows: order, duplicates, gaps, and the replacement of a missing settled price.

#include <gmock/gmock.h>

#include <cmath>

#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

QuarterHour settled(std::int64_t utc_s, double price) {
  QuarterHour row;
  row.utc_s = utc_s;
  row.price_eur_per_mwh = price;
  return row;
}

TEST(MarketJoin, SortsAndJoins) {
  const MarketRows rows{{{1020, 3}, {960, 2}, {900, 1}}, {settled(900, 50), settled(0, 40)}};
  const JoinedMarket market = join_market(rows, "test");
  ASSERT_EQ(market.series.size(), 30u);
  EXPECT_EQ(market.series.start_utc_s, 0);
  EXPECT_TRUE(std::isnan(market.series.indicative[14]));
  EXPECT_EQ(market.series.indicative[15], 1);
  EXPECT_EQ(market.series.indicative[17], 3);
  EXPECT_EQ(market.series.settled[14], 40);
  EXPECT_EQ(market.series.settled[15], 50);
  EXPECT_FALSE(market.report.settled_from_minutes);
}

TEST(MarketJoin, OfDuplicatesTheLastReadWinsButNotANull) {
  const MarketRows rows{{{0, 1}, {0, 2}, {60, 5}, {60, kNotPublished}}, {settled(0, 40)}};
  const JoinedMarket market = join_market(rows, "test");
  EXPECT_EQ(market.series.indicative[0], 2);
  EXPECT_EQ(market.series.indicative[1], 5);
  EXPECT_EQ(market.report.duplicates, 2u);
  EXPECT_EQ(market.report.duplicates_changed, 1u);
}

TEST(MarketJoin, MinutesAloneSettleAtMinute14) {
  MarketRows rows;
  for (int m = 0; m < 20; ++m) rows.minutes.push_back({m * 60, 100.0 + m});
  const JoinedMarket market = join_market(rows, "test");
  EXPECT_EQ(market.series.settled[0], 114);
  EXPECT_EQ(market.series.settled[14], 114);
  EXPECT_TRUE(std::isnan(market.series.settled[15]));  // the second quarter-hour is not over
  EXPECT_TRUE(market.report.settled_from_minutes);
}

TEST(MarketJoin, StrayDatesAndEmptinessAreRefused) {
  EXPECT_THAT(user_error_of([] { (void)join_market({}, "f.csv"); }), Names("f.csv"));
  const MarketRows rows{{{0, 1}, {4'000'000'020, 1}}, {}};
  EXPECT_THAT(user_error_of([&] { (void)join_market(rows, "f.csv"); }),
              Names("f.csv 1970-01-01T00:00:00Z 2096-10-02T07:08:00Z"));
  const MarketRows unpriced{{{0, kNotPublished}}, {settled(0, kNotPublished)}};
  EXPECT_THAT(user_error_of([&] { (void)join_market(unpriced, "f.csv"); }), Names("f.csv"));
}

TEST(MarketJoin, GapsAreReported) {
  const MarketRows rows{{{0, 1}, {180, 1}}, {settled(0, 40), settled(2700, 40)}};
  const std::string text = describe_join(join_market(rows, "test"));
  EXPECT_THAT(text, Names("1 1970-01-01T00:15:00Z 1970-01-01T00:45:00Z 30"));
  EXPECT_THAT(text, Names("2 1970-01-01T00:01:00Z 1970-01-01T00:03:00Z 58"));
}

constexpr const char* kImported =
    "# Source: Elia, opendata.elia.be, CC BY 4.0\n"
    "minute_utc,indicative_eur_mwh,settled_eur_mwh\n"
    "2023-01-01T00:00:00Z,10.5,-11.28\n"
    "2023-01-01T00:01:00Z,,-11.28\n"
    "2023-01-01T00:15:00Z,12,\n";

TEST(MarketJoin, AMinuteFileIsReadBack) {
  const MarketRows rows = parse_market_text(kImported, "imported.csv");
  EXPECT_EQ(rows.sources, std::set{MarketSource::kElia});
  ASSERT_EQ(rows.quarter_hours.size(), 1u);
  EXPECT_EQ(utc_text(rows.quarter_hours[0].utc_s), "2023-01-01T00:00:00Z");
  EXPECT_EQ(rows.quarter_hours[0].price_eur_per_mwh, -11.28);
  const JoinedMarket market = join_market(rows, "imported.csv");
  EXPECT_EQ(market.series.indicative[0], 10.5);
  EXPECT_TRUE(std::isnan(market.series.indicative[1]));
  EXPECT_EQ(market.series.settled[14], -11.28);
  EXPECT_TRUE(std::isnan(market.series.settled[15]));
  EXPECT_THAT(user_error_of([] {
                (void)parse_market_text(
                    "minute_utc,indicative_eur_mwh,settled_eur_mwh\n"
                    "2023-01-01T00:00:00Z,,1\n2023-01-01T00:14:00Z,,2\n",
                    "edited.csv");
              }),
              Names("edited.csv 2023-01-01T00:00:00Z 1 2"));
}

TEST(MarketJoin, AMinuteFileNamesWhatIsNotReal) {
  const auto sources = [](const std::string& comments) {
    return parse_market_text(
               comments + std::string(kImported).substr(std::string(kImported).find("minute_utc")),
               "f.csv")
        .sources;
  };
  EXPECT_EQ(sources(""), std::set{MarketSource::kUnknown});
  EXPECT_EQ(sources("# Simulated, not real: bess-train\n"), std::set{MarketSource::kSimulated});
  EXPECT_EQ(sources("# Source: ENTSO-E, transparency.entsoe.eu\n# Indicative prices: drawn, not "
                    "real: bess-train\n"),
            (std::set{MarketSource::kEntsoe, MarketSource::kDrawn}));
  for (const MarketSource source : {MarketSource::kSimulated, MarketSource::kDrawn}) {
    EXPECT_EQ(sources("# " + attribution_of({source}) + "\n"), std::set{source});
  }
}

TEST(MarketJoin, RealDownloadsMatchTheTidyFile) {
  const auto joined = [](const std::string& name) {
    return join_market(read_market_files({real_sample(name).string()}), name).series;
  };
  const MinuteSeries raw = joined("raw/ods161_2024-09-06.csv.gz");
  const MinuteSeries tidy = joined("elia_minute_2024-09-06.csv.gz");
  EXPECT_EQ(format_minute_csv(raw, ""), format_minute_csv(tidy, ""));
  EXPECT_EQ(raw.size(), 1137u);
  EXPECT_EQ(utc_text(raw.start_utc_s), "2024-09-05T22:00:00Z");
}

}  // namespace
}  // namespace bess
