// Day-ahead prices of public sources: documents, answers and tables; the download; and the
// commands.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>

#include "shared/utc_text.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/train_commands.h"
#include "tests/unit/workstation/data/market/feed/fake_charts.h"
#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

using testing::HasSubstr;

std::string a44_point(int position, const std::string& amount) {
  return fmt::format("<Point><position>{}</position><price.amount>{}</price.amount></Point>",
                     position, amount);
}

/// One local day of summer, 2025-06-01.
std::string a44(const std::string& points, const std::string& curve = "A03",
                const std::string& resolution = "PT60M", const std::string& unit = "EUR") {
  return "<?xml version=\"1.0\"?>\n<Publication_MarketDocument xmlns=\"urn:x\">\n<TimeSeries>"
         "<currency_Unit.name>" +
         unit + "</currency_Unit.name><price_Measure_Unit.name>MWH</price_Measure_Unit.name>" +
         "<curveType>" + curve +
         "</curveType><Period><timeInterval><start>2025-05-31T22:00Z</start>"
         "<end>2025-06-01T22:00Z</end></timeInterval><resolution>" +
         resolution + "</resolution>" + points +
         "</Period></TimeSeries></Publication_MarketDocument>\n";
}

JoinedDayAhead joined(const std::string& text) {
  return join_day_ahead(parse_day_ahead_text(text, "da").rows, "da");
}

std::string error_of(const std::string& text) {
  return user_error_of([&] { joined(text); });
}

TEST(DayAheadRows, HoursOfA44AreRepeatedAndMarked) {
  const JoinedDayAhead day =
      joined(a44(a44_point(1, "71.82") + a44_point(3, "-5") + a44_point(24, "9")));
  ASSERT_EQ(day.series.size(), 96u);  // A03: an omitted position repeats the previous one
  EXPECT_EQ(day.series.start_utc_s, utc_of("2025-05-31T22:00:00Z"));
  EXPECT_EQ(day.series.eur_per_mwh[0], 71.82);
  EXPECT_EQ(day.series.eur_per_mwh[7], 71.82);
  EXPECT_EQ(day.series.eur_per_mwh[8], -5);
  EXPECT_EQ(day.series.eur_per_mwh[95], 9);
  EXPECT_EQ(day.series.resolution_min[50], 60);
  EXPECT_EQ(day.repeated_hours, 24u);
  const JoinedDayAhead gap = joined(a44(a44_point(1, "71.82") + a44_point(3, "-5"), "A01"));
  EXPECT_EQ(gap.series.size(), 12u);
  EXPECT_TRUE(std::isnan(gap.series.eur_per_mwh[4]));
  const JoinedDayAhead quarters =
      joined(a44(a44_point(1, "1") + a44_point(2, "2"), "A03", "PT15M"));
  EXPECT_EQ(quarters.series.size(), 96u);
  EXPECT_EQ(quarters.series.resolution_min[1], 15);
}

TEST(DayAheadRows, BrokenDocumentsAreReportedByPlaceAndValue) {
  const std::string whole = a44(a44_point(1, "1"));
  const std::pair<std::string, const char*> cases[] = {
      {a44(a44_point(1, "x")), "da:3 \"x\""},
      {a44(a44_point(25, "1")), "da:3 25 24"},
      {a44(a44_point(1, "1") + a44_point(1, "2")), "da:3 1"},
      {a44(a44_point(1, "1"), "A03", "P1D"), "da:3 \"P1D\" PT15M"},
      {a44(a44_point(1, "1"), "A03", "PT60M", "PLN"), "da:3 \"PLN\" EUR"},
      {a44(""), "da"},
      {whole.substr(0, whole.size() / 2), "da:3"},
      {"<Balancing_MarketDocument/>", "da A44 \"Balancing_MarketDocument\""},
      {"<Acknowledgement_MarketDocument><Reason><text>No matching data</text></Reason>"
       "</Acknowledgement_MarketDocument>",
       "da \"No matching data\""}};
  for (const auto& [text, names] : cases) EXPECT_THAT(error_of(text), Names(names)) << text;
}

TEST(DayAheadRows, EnergyChartsOfHoursAndItsDamages) {
  const JoinedDayAhead day = joined(charts("1748728800,1748732400,1748736000", "10.5,null,12"));
  ASSERT_EQ(day.series.size(), 12u);
  EXPECT_EQ(day.series.eur_per_mwh[3], 10.5);
  EXPECT_TRUE(std::isnan(day.series.eur_per_mwh[4]));
  EXPECT_EQ(day.series.eur_per_mwh[11], 12);
  EXPECT_EQ(joined(charts("1748728800,1748732400", "1,\"2\"")).series.size(), 4u);
  const JoinedDayAhead apart = joined(charts("1748728800,1748736000", "1,2"));
  EXPECT_EQ(apart.series.size(), 12u);  // merged, or one is missing: not used for training
  EXPECT_TRUE(std::isnan(apart.series.eur_per_mwh[4]));
  EXPECT_EQ(apart.assumed, 4u);
}

/// A series of a zone and a sequence, quarter-hours or hours of one local day.
std::string a44_series(const std::string& zone, int sequence, const std::string& resolution,
                       double first) {
  const int count = resolution == "PT15M" ? 96 : 24;
  std::string points;
  for (int p = 1; p <= count; ++p) points += a44_point(p, fmt::format("{}", first + p));
  const std::string document = a44(points, "A01", resolution);
  const std::size_t begin = document.find("<TimeSeries>") + 12;
  const std::string body = document.substr(begin, document.find("</TimeSeries>") - begin);
  return fmt::format(
      "<TimeSeries><out_Domain.mRID codingScheme=\"A01\">{}</out_Domain.mRID>"
      "<classificationSequence_AttributeInstanceComponent.position>{}"
      "</classificationSequence_AttributeInstanceComponent.position>{}</TimeSeries>",
      zone, sequence, body);
}

std::string document_of(const std::string& series) {
  return "<Publication_MarketDocument>" + series + "</Publication_MarketDocument>";
}

TEST(DayAheadRows, OfTwoAuctionsTheDayAheadOneCounts) {
  const std::string hours = a44_series("10YDE", 1, "PT60M", 100);
  const std::string quarters = a44_series("10YDE", 2, "PT15M", 500);
  for (const std::string& both : {hours + quarters, quarters + hours}) {
    const DayAheadFile file = parse_day_ahead_text(document_of(both), "da");
    EXPECT_EQ(file.zone, "10YDE");
    EXPECT_THAT(file.unused, Names("96"));
    const JoinedDayAhead day = join_day_ahead(file.rows, "da");
    EXPECT_TRUE(day.findings.empty());
    ASSERT_EQ(day.series.size(), 96u);
    EXPECT_EQ(day.series.eur_per_mwh[0], 101);
    EXPECT_EQ(day.series.eur_per_mwh[95], 124);
  }
  // A later sequence alone is all there is.
  EXPECT_EQ(joined(document_of(quarters)).series.eur_per_mwh[0], 501);
}

TEST(DayAheadRows, OfTwoZonesNothingIsJoined) {
  const std::string be = a44_series("10YBE----------2", 1, "PT60M", 100);
  const std::string pt = a44_series("10YPT-REN------W", 1, "PT60M", 50);
  EXPECT_THAT(error_of(document_of(be + pt)), Names("10YBE----------2 10YPT-REN------W"));
  const TemporaryFolder folder;
  std::vector<std::string> notes;
  const std::vector<std::string> files{folder.write("be.xml", document_of(be)),
                                       folder.write("pt.xml", document_of(pt))};
  EXPECT_THAT(user_error_of([&] { rows_of_one_zone(files, notes); }),
              Names("be.xml pt.xml 10YPT-REN------W"));
  EXPECT_EQ(rows_of_one_zone({files[0], files[0]}, notes).size(), 48u);
}

TEST(DayAheadRows, ADayOfOnePriceIsLeftOut) {
  std::string times, prices;
  for (int h = 0; h < 48; ++h) {
    times += fmt::format("{}{}", h == 0 ? "" : ",", 1'748'728'800 + 3'600 * h);
    prices += fmt::format("{}{}", h == 0 ? "" : ",", h < 24 ? h : 0);
  }
  const JoinedDayAhead day = joined(charts(times, prices));
  EXPECT_EQ(day.series.size(), 96u);
  EXPECT_EQ(day.constant_days, 1u);
}

std::string table_of_day(const LocalDate& date, std::int64_t step_s, bool repeats_hours) {
  std::string text = "datetime_utc,price_eur_mwh\n";
  const std::int64_t end = local_midnight_utc_s(add_days(date, 1));
  for (std::int64_t utc_s = local_midnight_utc_s(date); utc_s < end; utc_s += step_s) {
    text += fmt::format("{},{}\n", utc_text(utc_s).view(),
                        repeats_hours ? utc_s / 3600 % 97 : utc_s / 900 % 97);
  }
  return text;
}

TEST(DayAheadRows, TablesOfHoursQuarterHoursAndClockChanges) {
  EXPECT_EQ(joined(table_of_day({2025, 3, 30}, 3600, true)).series.size(), 92u);
  EXPECT_EQ(joined(table_of_day({2024, 10, 27}, 3600, true)).series.size(), 100u);
  const JoinedDayAhead repeated = joined(table_of_day({2025, 6, 1}, 900, true));
  EXPECT_EQ(repeated.series.resolution_min[0], 60);
  EXPECT_EQ(repeated.repeated_hours, 24u);
  const JoinedDayAhead own = joined(table_of_day({2025, 10, 1}, 900, false));
  EXPECT_EQ(own.series.resolution_min[0], 15);
  EXPECT_EQ(own.repeated_hours, 0u);
  // Semicolons and decimal commas; and the written file, read again.
  const JoinedDayAhead commas =
      joined("Datetime;Price\n2025-06-01T00:00:00+02:00;1,5\n2025-06-01T00:15:00+02:00;-2\n");
  EXPECT_EQ(commas.series.eur_per_mwh[0], 1.5);
  const std::string written = format_day_ahead_csv(repeated.series, "");
  EXPECT_EQ(format_day_ahead_csv(joined(written).series, ""), written);
}

TEST(DayAheadRows, BrokenTablesAndAnswersAreReportedByPlace) {
  const std::string head = "datetime_utc,price_eur_mwh\n2025-06-01T00:00:00Z,1\n";
  const std::pair<std::string, const char*> cases[] = {
      {"datetime_utc,load\n", "da price_eur_mwh"},
      {"when,price\n", "da datetime_utc"},
      {head + "2025-06-01T00:15:00Z\n", "da:3 1 2"},
      {head + "2025-06-01T00:15:00,1\n", "da:3 \"2025-06-01T00:15:00\""},
      {head + "2025-06-01T00:15:00Z,inf\n", "da:3 \"inf\""},
      {"", "da"},
      {"PK\3\4zip", "ZIP"},
      {charts("1748728800,1748732400", "10.5"), "da unix_seconds price"},
      {charts("1748728800,-5", "1,2"), "da unix_seconds 1"},
      {charts("1748728800,1e300", "1,2"), "da unix_seconds 1"},
      {charts("1748728800,1748732400", "1,2", "GBP / MWh"), "\"GBP / MWh\" EUR / MWh"},
      {"{\"unix_seconds\":[1748", "da unix_seconds"},
      {charts("1748728800,1748729400", "1,2"), "da 2025-05-31T22:10:00Z"}};
  for (const auto& [text, names] : cases) EXPECT_THAT(error_of(text), Names(names)) << text;
  EXPECT_EQ(joined(head + "2025-06-01T00:15:00Z,2\n2025-06-01T00:00:00Z,3\n").findings.size(), 1u);
}

DayAheadRequest request_of(const FakeCharts& server, const FetchSpan& span) {
  return {.span = span,
          .base_url = server.base_url(),
          .now_utc_s = utc_of("2026-01-01T12:00:00Z"),
          .retry = {},
          .sleep = [](double, const std::atomic<bool>&) {}};
}

TEST(DayAheadFetch, AsksYearByYearAndTriesAgain) {
  FakeCharts server(2);
  const std::atomic<bool> interrupted{false};
  const auto fetched =
      fetch_day_ahead(request_of(server, {{2024, 1, 1}, {2025, 6, 30}}), interrupted);
  ASSERT_TRUE(fetched);
  EXPECT_EQ(server.requests(), 4);
  EXPECT_EQ(fetched->series.size(), (366u + 181u) * 96 - 4);  // clock changes: -4 +4 -4
  EXPECT_TRUE(incomplete_days(fetched->series).empty());
}

using DayAheadCli = TrainCommands;

TEST_F(DayAheadCli, ImportsJudgesAndLeavesNothingOfWhatIsBad) {
  const std::string good = written("good.csv", table_of_day({2025, 6, 1}, 3600, true));
  EXPECT_THAT(said({"prices", "import", "--day-ahead", good, "--out", path("da.csv")}),
              Names("96 2025-05-31T22:00:00Z 2025-06-01T22:00:00Z 24"));
  EXPECT_THAT(read_file(path("da.csv")), HasSubstr("2025-05-31T22:15:00Z,"));
  EXPECT_THAT(run({"prices", "stats", path("da.csv")}).output, Names("EUR/MWh 96 66.25"));
  const std::string other = written("other.csv",
                                    "datetime_utc,price_eur_mwh\n"
                                    "2025-05-31T22:00:00Z,-9999\n"
                                    "2025-05-31T23:00:00Z,5\n");
  for (const auto& files : {std::vector<std::string>{other}, {good, other}, {path("absent.xml")}}) {
    std::vector<std::string> arguments{"prices", "import", "--day-ahead", "--out", path("bad.csv")};
    arguments.insert(arguments.end(), files.begin(), files.end());
    said(arguments, 1);
    EXPECT_FALSE(std::filesystem::exists(path("bad.csv")));
  }
  // Of the other kind: each error names the remedy.
  const std::string document = written("a44.xml", a44(a44_point(1, "5")));
  EXPECT_THAT(run({"prices", "import", document, "--out", path("bad.csv")}).output,
              Names("a44.xml \"Publication_MarketDocument\" --day-ahead"));
  EXPECT_FALSE(std::filesystem::exists(path("bad.csv")));
}

TEST_F(DayAheadCli, FetchWritesAFileOrNothing) {
  FakeCharts server;
  std::vector<std::string> fetch{"prices",          "fetch", "--day-ahead",    "--from",
                                 "2025-06-01",      "--to",  "2025-06-07",     "--base-url",
                                 server.base_url(), "--out", path("da.csv.gz")};
  said(fetch);
  EXPECT_EQ(parse_day_ahead_csv(read_file(path("da.csv.gz")), "da").size(), 7u * 96);
  std::filesystem::remove(path("da.csv.gz"));
  server.missing_utc_s = utc_of("2025-06-03T10:00:00Z");
  EXPECT_THAT(said(fetch, 1), Names("92 96 2025-06-03 --allow-gaps"));
  EXPECT_FALSE(std::filesystem::exists(path("da.csv.gz")));
  fetch.emplace_back("--allow-gaps");
  said(fetch);
}

// The planted look-ahead: every price dated a day early reveals tomorrow's auction today.
TEST_F(DayAheadCli, AnOutlookFiledUnderTheWrongDayIsRefused) {
  said({"prices", "simulate", "--days", "90", "--out", path("market.csv.gz"), "--day-ahead-out",
        path("da.csv")});
  std::vector<std::string> evaluate{
      "evaluate", "--prices", path("market.csv.gz"), "--policy",    "sdp", "sdp-outlook",
      "--split",  "val",      "--day-ahead",         path("da.csv")};
  EXPECT_THAT(said(evaluate), HasSubstr("sdp-outlook"));
  DayAheadSeries series = parse_day_ahead_csv(read_file(path("da.csv")), "da.csv");
  series.start_utc_s -= 86'400;
  write_day_ahead_file(path("shifted.csv"), series, "");
  evaluate.back() = path("shifted.csv");
  EXPECT_THAT(said(evaluate, 1), Names("shifted.csv --accept shifted-day"));
  evaluate.resize(evaluate.size() - 2);
  EXPECT_THAT(run(evaluate).output, Names("--policy sdp-outlook --day-ahead"));
}

}  // namespace
}  // namespace bess
