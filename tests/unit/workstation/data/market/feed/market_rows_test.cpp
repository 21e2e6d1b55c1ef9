// Market readers: every spelling of Elia's downloads, and one clear line for unreadable rows.
#include <gmock/gmock.h>

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

constexpr std::int64_t k2024September6At1656Utc_s = 1'725'641'760;

TEST(MarketCsv, PortalMinutesWithByteOrderMarkAndNulls) {
  const MarketRows rows = parse_market_text(
      "\xEF\xBB\xBF"
      "Datetime;Resolution code;Quarter hour;Quality status;ACE;System imbalance;Alpha;Alpha';"
      "Marginal incremental price;Marginal decremental price;Imbalance Price\r\n"
      "2024-09-06T18:56:00+02:00;PT1M;2024-09-06T18:45:00+02:00;NV;-55.073;-107.004;0.0;0.0;"
      "369.425;-10.338;369.425\r\n"
      "2025-04-08T08:02:00+02:00;PT1M;2025-04-08T08:00:00+02:00;DataIssue;-69.292;-126.48;;"
      "0.0;;55.0;\r\n",
      "portal.csv");
  ASSERT_EQ(rows.minutes.size(), 2u);
  EXPECT_TRUE(rows.quarter_hours.empty());
  EXPECT_EQ(rows.minutes[0].utc_s, k2024September6At1656Utc_s);
  EXPECT_EQ(rows.minutes[0].indicative_eur_per_mwh, 369.425);
  EXPECT_TRUE(std::isnan(rows.minutes[1].indicative_eur_per_mwh));
}

TEST(MarketCsv, OldQuarterHoursByLabelAndByApiName) {
  const char* row =
      "2023-01-01T00:00:00+01:00;Validated;PT15M;-145.361;153.32;1.09;59.39;-10.19;;-11.28;"
      "-11.28\n";
  for (const char* header :
       {"DateTime;Quality status;Resolution code;Net regulation volume;System imbalance;Alpha;"
        "Marginal incremental price;Marginal decremental price;Strategic reserve price;Positive "
        "imbalance price;Negative imbalance price\n",
        "datetime;qualitystatus;resolutioncode;netregulationvolume;systemimbalance;alpha;"
        "marginalincrementalprice;marginaldecrementalprice;strategicreserveprice;"
        "positiveimbalanceprice;negativeimbalanceprice\n"}) {
    const MarketRows rows = parse_market_text(std::string(header) + row, "ods047.csv");
    ASSERT_EQ(rows.quarter_hours.size(), 1u);
    const QuarterHour& first = rows.quarter_hours[0];
    EXPECT_EQ(first.utc_s, 1'672'527'600);
    EXPECT_EQ(first.price_eur_per_mwh, -11.28);
    EXPECT_EQ(first.system_imbalance_mw, 153.32);
    EXPECT_EQ(first.alpha_eur_per_mwh, 1.09);
    EXPECT_EQ(first.marginal_incremental_eur_per_mwh, 59.39);
    EXPECT_EQ(first.marginal_decremental_eur_per_mwh, -10.19);
  }
}

TEST(MarketCsv, TidyCommaFilesAndQuotes) {
  const MarketRows quarter_hours = parse_market_text(
      "datetime_utc,price_eur_mwh,system_imbalance_mw,nrv_mw,alpha_eur_mwh,mip_eur_mwh,mdp_eur_mwh,"
      "quality\n2022-12-31T23:00:00Z,-11.28,153.32,-145.361,1.09,59.39,-10.19,\"a,b\"\n",
      "tidy.csv");
  ASSERT_EQ(quarter_hours.quarter_hours.size(), 1u);
  EXPECT_EQ(quarter_hours.quarter_hours[0].marginal_decremental_eur_per_mwh, -10.19);
  const MarketRows minutes = parse_market_text(
      "datetime_utc,quarter_hour_utc,price_eur_mwh\n\"2024-09-05T22:01:00Z\",2024-09-05T22:00:00Z,"
      "80.0\n",
      "tidy.csv");
  ASSERT_EQ(minutes.minutes.size(), 1u);
}

TEST(MarketCsv, TwoDifferentPricesAreNotOne) {
  const MarketRows rows = parse_market_text(
      "datetime;resolutioncode;positiveimbalanceprice;negativeimbalanceprice\n"
      "2023-01-01T00:00:00Z;PT15M;10;60\n"
      "2023-01-01T00:15:00Z;PT15M;10;10\n"
      "2023-01-01T00:30:00Z;PT15M;;20\n"
      "2023-01-01T00:45:00Z;PT15M;30;\n"
      "2023-01-01T01:00:00Z;PT15M;;\n"
      "2023-01-01T00:00:00Z;PT1M;1;2\n",
      "ods047.csv");
  ASSERT_EQ(rows.quarter_hours.size(), 5u);
  EXPECT_TRUE(std::isnan(rows.quarter_hours[0].price_eur_per_mwh));
  EXPECT_EQ(rows.quarter_hours[1].price_eur_per_mwh, 10);
  EXPECT_EQ(rows.quarter_hours[2].price_eur_per_mwh, 20);
  EXPECT_EQ(rows.quarter_hours[3].price_eur_per_mwh, 30);
  EXPECT_TRUE(std::isnan(rows.quarter_hours[4].price_eur_per_mwh));
  EXPECT_TRUE(std::isnan(rows.minutes.at(0).indicative_eur_per_mwh));
  EXPECT_THAT(rows.dual_priced_quarter_hours, testing::ElementsAre(1'672'531'200));
  EXPECT_THAT(rows.dual_priced_minutes, testing::ElementsAre(1'672'531'200));
}

TEST(MarketJson, TwoDifferentPricesAreNotOne) {
  const MarketRows rows =
      parse_market_text(R"([{"datetime":"2023-01-01T00:00:00Z","resolutioncode":"PT15M",)"
                        R"("positiveimbalanceprice":10,"negativeimbalanceprice":60},)"
                        R"({"datetime":"2023-01-01T00:15:00Z","resolutioncode":"PT15M",)"
                        R"("positiveimbalanceprice":null,"negativeimbalanceprice":60},)"
                        R"({"datetime":"2023-01-01T00:30:00Z","resolutioncode":"PT15M",)"
                        R"("imbalanceprice":null}])",
                        "ods047.json");
  ASSERT_EQ(rows.quarter_hours.size(), 3u);
  EXPECT_TRUE(std::isnan(rows.quarter_hours[2].price_eur_per_mwh));
  EXPECT_TRUE(std::isnan(rows.quarter_hours[0].price_eur_per_mwh));
  EXPECT_EQ(rows.quarter_hours[1].price_eur_per_mwh, 60);
  EXPECT_EQ(rows.dual_priced_quarter_hours.size(), 1u);
}

TEST(MarketText, SaysWhoseDataItIs) {
  EXPECT_THAT(parse_market_text("datetime;resolutioncode;imbalanceprice\n"
                                "2025-01-01T00:00:00Z;PT15M;1\n",
                                "elia.csv")
                  .sources,
              testing::ElementsAre(MarketSource::kElia));
  EXPECT_THAT(
      parse_market_text("datetime_utc,price_eur_mwh\n2025-01-01T00:00:00Z,1\n", "tidy.csv").sources,
      testing::ElementsAre(MarketSource::kUnknown));
  EXPECT_THAT(attribution_of({MarketSource::kEntsoe}),
              testing::AllOf(Names("ENTSO-E"), testing::Not(Names("Elia"))));
  EXPECT_THAT(attribution_of({MarketSource::kElia, MarketSource::kUnknown}),
              Names("Elia opendata.elia.be CC BY 4.0"));
}

TEST(MarketText, WhatIsNoTextIsNamed) {
  using namespace std::string_view_literals;
  const auto error_of = [](std::string_view text) {
    return user_error_of([&] { (void)parse_market_text(text, "f"); });
  };
  EXPECT_THAT(error_of("PK\x03\x04\x14\0\0"sv), Names("f ZIP"));
  EXPECT_THAT(error_of("\xFF\xFE"
                       "d\0a\0"sv),
              Names("f UTF-16 UTF-8"));
  EXPECT_THAT(error_of("d\0a\0t\0e\0"sv), Names("f NUL UTF-8"));
  EXPECT_THAT(error_of(" \n<!DOCTYPE HTML><html>"), Names("f"));
}

TEST(PlainText, MessagesStayOnOneLineAndQuiet) {
  EXPECT_EQ(one_line("bad\x1b[31m where\r\n\n second \xC2\x9B line\n", 200),
            "bad [31m where second line");
  EXPECT_EQ(one_line("abcdef", 3), "abc");
  EXPECT_EQ(one_line("ab\xC3\xA9", 3), "ab");  // no half characters
  const std::string text = user_error_of([] {
    (void)parse_market_text("datetime;imbalanceprice\n2025-01-01T00:00:00Z;\x1b[31m\n", "f");
  });
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("\x1b")));
}

TEST(MarketCsv, AlphaPrimeIsNotAlpha) {
  EXPECT_EQ(market_field_of("Alpha"), MarketField::kAlpha);
  EXPECT_EQ(market_field_of("Alpha'"), std::nullopt);
  EXPECT_EQ(market_field_of("alpha_prime"), std::nullopt);
  EXPECT_EQ(market_field_of("Imbalance Price"), MarketField::kPrice);
  EXPECT_EQ(market_field_of("Negative imbalance price"), MarketField::kNegativePrice);
}

TEST(MarketJson, RecordsExportsAndVersion1) {
  const std::string record =
      R"({"datetime":"2025-08-17T00:36:00+00:00","resolutioncode":"PT1M",)"
      R"("quarterhour":"2025-08-17T00:30:00+00:00","qualitystatus":"DataIssue","ace":-4.387,)"
      R"("systemimbalance":237.58,"alpha":6.258,"alpha_prime":null,)"
      R"("marginalincrementalprice":127.3,"marginaldecrementalprice":-24.0,"imbalanceprice":-30.258})";
  for (const std::string& text :
       {"[" + record + "]", R"({"total_count": 4, "results": [)" + record + "]}",
        R"( {"nhits": 1, "records": [{"datasetid": "ods161", "fields": )" + record + "}]}"}) {
    const MarketRows rows = parse_market_text(text, "answer.json");
    ASSERT_EQ(rows.minutes.size(), 1u) << text;
    EXPECT_EQ(rows.minutes[0].utc_s, 1'755'390'960);
    EXPECT_EQ(rows.minutes[0].indicative_eur_per_mwh, -30.258);
  }
}

TEST(MarketJson, ADuplicateMemberIsRefused) {
  const std::string row =
      R"("datetime":"2025-08-17T00:15:00Z","resolutioncode":"PT15M","imbalanceprice":5)";
  const auto complaint = [](const std::string& text) {
    return user_error_of([&] { (void)parse_market_json(text, "f.json"); });
  };
  EXPECT_THAT(complaint("[{" + row + R"(,"imbalanceprice":9}])"),
              Names(R"(f.json 1 "imbalanceprice")"));
  EXPECT_THAT(complaint(R"({"records":[{"fields":{)" + row + R"(,"imbalanceprice":5}}]})"),
              Names(R"(f.json 1 "imbalanceprice")"));
  EXPECT_THAT(complaint(R"({"results":[{)" + row + R"(}],"results":[]})"),
              Names(R"(f.json "results")"));
  EXPECT_EQ(parse_market_json("[{" + row + "}]", "f.json").quarter_hours.size(), 1u);
}

TEST(MarketText, BadInputIsOneClearLine) {
  const std::string header = "datetime;resolutioncode;imbalanceprice\n";
  const auto error_of = [](const std::string& text) {
    return user_error_of([&] { (void)parse_market_text(text, "f.csv"); });
  };
  const std::pair<std::string, const char*> cases[] = {
      {"", "f.csv"},
      {"a;b\n1;2\n", "f.csv \"a;b\" --time-column"},
      {"datetime;b\n", "f.csv \"datetime;b\" --price-column"},
      {header + "2025-01-01T00:00:00Z;PT1M;abc\n", "f.csv:2 \"abc\""},
      {header + "2025-01-01T00:00:00Z;PT1M;inf\n", "f.csv:2 \"inf\""},
      {header + "2025-01-01T00:00:00;PT1M;1\n", "f.csv:2 \"2025-01-01T00:00:00\""},
      {header + "2025-01-01T00:00:00Z;PT1M\n", "f.csv:2 2 3"},
      {header + "2025-01-01T00:00:00Z;PT1H;1\n", "f.csv:2 \"PT1H\""},
      {header + "2025-01-01T00:05:00Z;PT15M;1\n", "f.csv:2 2025-01-01T00:05:00Z"},
      {header + ";PT15M;1\n", "f.csv:2"},
      {"[{\"datetime\":", "f.csv JSON"},
      {"{\"error\":\"x\"}", "f.csv \"results\""},
      {"[7]", "f.csv 1"},
      {R"([{"datetime":5}])", "f.csv 1 \"datetime\""}};
  for (const auto& [text, names] : cases) EXPECT_THAT(error_of(text), Names(names)) << text;
}

// Joining rows: order, duplicates, gaps, and the replacement of a missing settled price.

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
