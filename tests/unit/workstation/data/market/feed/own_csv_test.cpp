// Own CSV files: columns and separators are found, times are interpreted exactly, and ambiguous
// input is refused by its line.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "shared/local_time.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

CustomCsvFormat form(const std::string& date_format, std::optional<WallClock> clock) {
  return {.time_column = "", .price_column = "", .times = {date_format, clock}};
}
const CustomCsvFormat kBelgian = form("dd/mm/yyyy", WallClock::kLocal);

struct OwnCase {
  std::string text;
  const char* names;  ///< named in the error, its place first; the form of an accepted one
  CustomCsvFormat own{};
};

/// All mean 10.5 at 2025-01-31T00:15Z and nothing half an hour before.
TEST(OwnCsv, FormsThatAreRead) {
  const std::vector<OwnCase> cases{
      {"datetime_utc,price_eur_mwh\n2025-01-31T00:15:00Z,10.5\n2025-01-31T00:00:00Z,\n", "tidy"},
      {"Datetime;Price\n2025-01-31T01:15+01:00;10,5\n2025-01-31T01:00+01:00;NaN\n", "semicolons"},
      {"\xEF\xBB\xBFTime (UTC)\tPrice [EUR/MWh]\r\n2025-01-31 00:15\t10,5\r\n"
       "2025-01-31 00:00\tn/a\r\n",
       "tabs and a mark"},
      {"# mine\n\"Timestamp\",\"EUR/MWh\",\"x\"\n\"2025-01-31 00:15:00Z\",\"10.5\",\"a,b\"\n"
       "2025-01-31 00:00:00.000Z,N/A,\n",
       "quotes and comments"},
      {"DATE;IMBALANCE PRICE \xE2\x82\xAC/MWh\n31/01/2025 1:15;10,5\n31/1/2025 01:00;\n", "Belgian",
       kBelgian},
      {"date,settled\n01/31/2025 00:15, 10.5 \n1/31/2025 00:00,null\n", "American",
       form("mm/dd/yyyy", WallClock::kUtc)},
      {"timestamp,price\n31.01.2025 01:15,10.5\n31.01.2025 01:00,\n", "German",
       form("dd.mm.yyyy", WallClock::kLocal)},
      {"quarter_hour_utc,price\n2025-01-31T00:15:00Z,10.5\n2025-01-31T00:00:00Z,\n",
       "a quarter-hour's column"},
      {"price,time,When,What\n1,2,2025-01-31T00:15:00Z,10.5\n1,2,2025-01-31T00:00:00Z,\n",
       "named",
       {.time_column = "when", .price_column = "What", .times = {}}},
      {"time,price\n2025-01-31T00:15:00Z,10.5\n2025-01-31T00:00:00Z,\n2025-01-31T00:15:00Z,10.50\n",
       "equal rows"}};
  for (const OwnCase& c : cases) {
    SCOPED_TRACE(c.names);
    const MarketRows rows = parse_market_text(c.text, "own.csv", c.own);
    EXPECT_TRUE(rows.minutes.empty());
    ASSERT_GE(rows.quarter_hours.size(), 2u);
    EXPECT_EQ(rows.quarter_hours[0].utc_s, utc_of("2025-01-31T00:15:00Z"));
    EXPECT_EQ(rows.quarter_hours[0].price_eur_per_mwh, 10.5);
    EXPECT_EQ(rows.quarter_hours[1].utc_s, utc_of("2025-01-31T00:00:00Z"));
    EXPECT_TRUE(std::isnan(rows.quarter_hours[1].price_eur_per_mwh));
  }
}

TEST(OwnCsv, FormsThatAreRefused) {
  const std::string head = "time,price\n2025-01-31T00:00:00Z,1\n";
  const std::string local = "time;price\n";
  const std::vector<OwnCase> cases{
      {"a,b\n1,2\n", "own.csv \"a,b\" --time-column"},
      {"2025-01-31T00:00:00Z,1\n", "own.csv datetime_utc,price_eur_mwh"},
      {"time,load\n", "own.csv \"time,load\" --price-column"},
      {"date,time,price\n", "own.csv \"date\" \"time\" --time-column"},
      {"time,price,settled\n", "own.csv \"price\" \"settled\" --price-column"},
      {head, "own.csv \"time,price\" --time-column", {"when", "", {}}},
      {head, "own.csv \"time,price\" --price-column", {"", "what", {}}},
      {"time,price EUR/kWh\n", "own.csv \"price EUR/kWh\" 1000"},
      {"time,ct/kWh\n", "own.csv \"ct/kWh\" 10"},
      {"time,what_kwh\n", "own.csv \"what_kwh\" 1000", {"", "what_kwh", {}}},
      {"time,price\n31/01/2025 00:00,1\n", "own.csv:2 \"31/01/2025 00:00\" --date-format"},
      {"time;price\n2025-01-31 00:00;1\n", "own.csv:2 \"2025-01-31 00:00\" --time-zone"},
      {head + "2025-01-31 00:15,1\n", "own.csv:3 --time-zone"},
      {local + "31/13/2025 00:00;1\n", "own.csv:2 \"31/13/2025 00:00\"", kBelgian},
      {local + "30/02/2025 00:00;1\n", "own.csv:2 \"30/02/2025 00:00\"", kBelgian},
      {local + "01/02/25 00:00;1\n", "own.csv:2 \"01/02/25 00:00\"", kBelgian},
      {local + "01/02/2025;1\n", "own.csv:2 \"01/02/2025\"", kBelgian},
      {local + "01/02/2025 24:00;1\n", "own.csv:2 \"01/02/2025 24:00\"", kBelgian},
      {local + ";1\n", "own.csv:2 \"\"", kBelgian},
      {local + "30/03/2025 02:15;1\n", "own.csv:2 \"30/03/2025 02:15\" UTC", kBelgian},
      {local + "26/10/2025 02:15;1\n", "own.csv:2 \"26/10/2025 02:15\" UTC", kBelgian},
      {head + "2025-01-31T01:00:00Z,1\n", "own.csv 60 --day-ahead"},
      {head + "2025-01-31T00:05:00Z,1\n", "own.csv 5 --day-ahead"},
      {head + "2025-01-31T00:15:00Z,1\n2025-01-31T00:30:00Z,1\n2025-01-31T00:31:00Z,1\n",
       "own.csv:5 2025-01-31T00:31:00Z"},
      {"time,price\n2025-01-31T00:00:30Z,1\n2025-01-31T00:01:30Z,1\n",
       "own.csv:2 2025-01-31T00:00:30Z"},
      {head + "2025-01-31T00:15:00Z,2\n2025-01-31T00:00:00Z,3\n", "own.csv:4 2 3 1"},
      {head + "2025-01-31T00:15:00Z,1,5\n", "own.csv:3 3 2"},
      {head + "2025-01-31T00:15:00Z,high\n", "own.csv:3 \"high\""},
      {local + "01/02/2025 00:00;1.234,5\n", "own.csv:2 \"1.234,5\"", kBelgian}};
  for (const OwnCase& c : cases) {
    SCOPED_TRACE(c.text);
    const std::string error =
        user_error_of([&] { (void)parse_market_text(c.text, "own.csv", c.own); });
    EXPECT_THAT(error, Names(c.names));
    EXPECT_EQ(error.find('\n'), error.npos);
  }
}

/// "31/01/2025 00:15" by Belgian clocks.
std::string belgian(std::int64_t utc_s) {
  const LocalMinute t = local_minute_of(utc_s);
  return fmt::format("{:02}/{:02}/{} {:02}:{:02}", t.day, t.month, t.year, t.minute_of_day / 60,
                     t.minute_of_day % 60);
}

std::string belgian_file(const std::vector<std::int64_t>& times) {
  std::string text = "date;price\n";
  for (const std::int64_t utc_s : times) text += belgian(utc_s) + ";1\n";
  return text;
}

std::vector<std::int64_t> times_of(const MarketRows& rows) {
  std::vector<std::int64_t> times;
  for (const QuarterHour& row : rows.quarter_hours) times.push_back(row.utc_s);
  for (const MinuteRow& row : rows.minutes) times.push_back(row.utc_s);
  return times;
}

TEST(OwnCsv, ClockChangesByTheOrderOfTheRows) {
  struct Day {
    const char* from;
    std::int64_t quarter_hours;
  };
  for (const Day& day : {Day{"2025-03-29T23:00:00Z", 92}, Day{"2025-06-01T22:00:00Z", 96},
                         Day{"2025-10-25T22:00:00Z", 100}}) {
    SCOPED_TRACE(day.from);
    std::vector<std::int64_t> times;
    for (std::int64_t q = 0; q < day.quarter_hours; ++q) {
      times.push_back(utc_of(day.from) + 900 * q);
    }
    for (const bool newest_first : {false, true}) {
      EXPECT_EQ(times_of(parse_market_text(belgian_file(times), "own.csv", kBelgian)), times)
          << newest_first;
      std::ranges::reverse(times);
    }
  }
}

TEST(OwnCsv, AnHourThatComesTwiceIsNotGuessed) {
  const std::int64_t hour_s = utc_of("2025-10-26T00:00:00Z");  // 02:00, and again at 01:00 UTC
  const auto error_of = [](const std::vector<std::int64_t>& times) {
    return user_error_of(
        [&] { (void)parse_market_text(belgian_file(times), "own.csv", kBelgian); });
  };
  const std::int64_t q = 900;
  EXPECT_THAT(error_of({hour_s - q, hour_s, hour_s + q, hour_s + 2 * q, hour_s + 3 * q}),
              Names("own.csv:3 \"26/10/2025 02:00\""));
  EXPECT_THAT(error_of({hour_s, hour_s, hour_s + q, hour_s + q, hour_s + 2 * q}),
              Names("own.csv:6 \"26/10/2025 02:30\""));
  EXPECT_THAT(error_of({hour_s, hour_s, hour_s, hour_s + q}),
              Names("own.csv:4 \"26/10/2025 02:00\""));
}

/// A random series in a random form, with gaps, duplicates and any order, reads back the same.
TEST(OwnCsv, DrawnFormsReadBack) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 draws(seed);
    const auto one_of = [&draws](std::size_t count) { return draws() % count; };
    const std::int64_t step_s = one_of(2) == 0 ? 60 : 900;
    const std::int64_t from_s = utc_of("2024-01-01T00:00:00Z") + 86'400 * one_of(700);
    const char separator = ",;\t"[one_of(3)];
    const std::size_t clock = one_of(3);  // an offset, UTC, local
    const std::size_t order = one_of(3);
    const char* formats[] = {"yyyy-mm-dd", "dd/mm/yyyy", "mm/dd/yyyy"};
    const char* line_end = one_of(2) == 0 ? "\n" : "\r\n";
    const char* between = one_of(2) == 0 ? " " : "T";
    CustomCsvFormat own = form(formats[order], std::nullopt);
    if (clock == 1) own.times.clock = WallClock::kUtc;
    if (clock == 2) own.times.clock = WallClock::kLocal;
    const char* times[] = {"Datetime", "TIME", "timestamp", "Date"};
    const char* prices[] = {"Price", "price_eur_mwh", "Imbalance price [EUR/MWh]", "settled price"};
    std::string head = fmt::format("{}{}note{}{}{}", times[one_of(4)], separator, separator,
                                   prices[one_of(4)], line_end);
    std::vector<std::pair<std::int64_t, double>> rows;
    std::vector<std::string> lines;
    for (int i = 0; i < 300; ++i) {
      if (i > 2 && one_of(20) == 0) continue;
      const std::int64_t utc_s = from_s + step_s * i;
      const double price =
          one_of(30) == 0 ? kNotPublished : (static_cast<double>(one_of(200'000)) - 50'000) / 100;
      const std::int64_t offset_s = clock == 0 ? 3'600 * static_cast<std::int64_t>(one_of(3)) : 0;
      CivilTime t = civil_from_utc(utc_s + offset_s);
      if (clock == 2) {
        const LocalMinute local = local_minute_of(utc_s);
        t = {local.year, local.month, local.day, local.minute_of_day / 60, local.minute_of_day % 60,
             0};
      }
      const std::string date = order == 0   ? fmt::format("{}-{:02}-{:02}", t.year, t.month, t.day)
                               : order == 1 ? fmt::format("{:02}/{:02}/{}", t.day, t.month, t.year)
                                            : fmt::format("{}/{}/{}", t.month, t.day, t.year);
      std::string number = is_published(price) ? fmt::format("{}", price) : "";
      if (separator != ',') std::ranges::replace(number, '.', ',');
      lines.push_back(fmt::format("{}{}{:02}:{:02}{}{}x{}\"{}\"{}", date, between, t.hour, t.minute,
                                  clock == 0 ? fmt::format("+{:02}:00", offset_s / 3'600) : "",
                                  separator, separator, number, line_end));
      rows.emplace_back(utc_s, price);
    }
    // Belgian clocks need the order in the repeated hour; here it is one way or the other.
    if (clock == 2) {
      if (one_of(2) == 0) std::ranges::reverse(lines), std::ranges::reverse(rows);
    } else {
      const std::size_t twice = one_of(lines.size());
      lines.push_back(lines[twice]);
      rows.push_back(rows[twice]);
      std::mt19937 same = draws;
      std::ranges::shuffle(lines, draws);
      std::ranges::shuffle(rows, same);
    }
    std::string text = head;
    for (const std::string& line : lines) text += line;
    const MarketRows read = parse_market_text(text, "own.csv", own);
    ASSERT_EQ((step_s == 60 ? read.quarter_hours.size() : read.minutes.size()), 0u);
    ASSERT_EQ(times_of(read).size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(times_of(read)[i], rows[i].first);
      const double price = step_s == 60 ? read.minutes[i].indicative_eur_per_mwh
                                        : read.quarter_hours[i].price_eur_per_mwh;
      EXPECT_TRUE(price == rows[i].second || (std::isnan(price) && std::isnan(rows[i].second)));
    }
  }
}

}  // namespace
}  // namespace bess
