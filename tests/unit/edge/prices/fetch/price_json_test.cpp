// Price answers: real formats, nulls, disorder, future stamps, garbage.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "edge/prices/fetch/price_json.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::int64_t utc(std::string_view text) {
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc(text, utc_s)) << text;
  return utc_s;
}

const std::int64_t kAsked = utc("2025-08-17T00:38:00Z");

Status parse(std::string_view json, PriceRow& row) {
  return parse_newest_price(json, PriceFields{}, kAsked, row);
}

/// The row of an answer that must have one.
PriceRow newest_of(std::string_view json) {
  PriceRow row;
  EXPECT_EQ(parse(json, row), Status::kOk) << json;
  return row;
}

TEST(PriceJson, TakesTheNewestOfTheApiAnswerInAnyOrder) {
  const PriceRow row = newest_of(R"({"total_count": 4, "results": [
 {"datetime":"2025-08-17T00:00:00+00:00","resolutioncode":"PT1M","imbalanceprice":43.944},
 {"datetime":"2025-08-17T00:36:00+00:00","qualitystatus":"DataIssue","imbalanceprice":-30.258},
 {"datetime":"2025-08-17T00:35:00+00:00","imbalanceprice":1.0}]})");
  EXPECT_EQ(row.minute_utc_s, utc("2025-08-17T00:36:00Z"));
  EXPECT_EQ(row.price_centi_eur_per_mwh, -3'026);
}

TEST(PriceJson, SkipsNullsAndKeepsThePreviousOne) {
  const PriceRow row =
      newest_of(R"({"results":[{"datetime":"2025-08-17T00:37:00+00:00","imbalanceprice":null},
                     {"datetime":"2025-08-17T02:36:00+02:00","imbalanceprice":7}]})");
  EXPECT_EQ(row.minute_utc_s, utc("2025-08-17T00:36:00Z"));  // local offset understood
  EXPECT_EQ(row.price_centi_eur_per_mwh, 700);
}

TEST(PriceJson, AMinuteCountsFromItsEndButForTheClocksTolerance) {
  constexpr std::int64_t kToleranceS = 5;
  const std::int64_t minute_utc_s = utc("2025-08-17T00:37:00Z");
  const char* const json = R"([{"datetime":"2025-08-17T00:37:00Z","imbalanceprice":1}])";
  PriceRow row;
  const std::int64_t first_utc_s = minute_utc_s + 60 - kToleranceS;
  EXPECT_EQ(parse_newest_price(json, PriceFields{}, first_utc_s, row), Status::kOk);
  EXPECT_EQ(parse_newest_price(json, PriceFields{}, first_utc_s - 1, row), Status::kNoRow);
}

/// Settled prices, allowed bids, and the limit itself: each to the cent.
TEST(PriceJson, PricesAreExactToTheLimit) {
  const std::map<std::string, std::int32_t> centi_of = {{"25907.54", 2'590'754},
                                                        {"-25907.54", -2'590'754},
                                                        {"99999", 9'999'900},
                                                        {"-99999", -9'999'900},
                                                        {"99999.99", 9'999'999},
                                                        {"1e5", 10'000'000},
                                                        {"-1.0E+5", -10'000'000},
                                                        {"-999", -99'900},
                                                        {"15000.01", 1'500'001},
                                                        {"2.590754e4", 2'590'754},
                                                        {"-0", 0},
                                                        {"-0.004", 0},
                                                        {"0.005", 1},
                                                        {"-9999", -999'900},
                                                        {"1e-300", 0}};
  for (const auto& [text, centi] : centi_of) {
    PriceRow row{.price_centi_eur_per_mwh = 7};
    EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":)" + text + "}]", row),
              Status::kOk)
        << text;
    EXPECT_EQ(row.price_centi_eur_per_mwh, centi) << text;
  }
}

TEST(PriceJson, WhatIsNoNumberIsNoPrice) {
  const auto status_of = [](const std::string& price) {
    PriceRow row;
    return parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":)" + price + "}]", row);
  };
  for (const char* price :
       {"\"25907.54\"", "\"\"", "true", "[5]", "{}", "null", "1e6", "100001", "-1e300", "1e999",
        "-1e999", "100000.01", "NaN", "Infinity", "-Infinity"}) {
    EXPECT_EQ(status_of(price), Status::kNoRow) << price;
  }
  for (const char* price :
       {"-", "+5", ".5", "0x10", "1,5", "1e", "5 6", "--5", "1.2.3", "", "'5'"}) {
    EXPECT_EQ(status_of(price), Status::kMalformed) << price;
  }
}

TEST(PriceJson, NothingMayFollowTheDocument) {
  const std::string whole = R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":5}])";
  PriceRow row;
  for (const std::string& rest : std::vector<std::string>{"", " ", "\r\n\t \n"}) {
    EXPECT_EQ(parse(whole + rest, row), Status::kOk);
  }
  for (const std::string& rest :
       {whole, std::string("]"), std::string("<html>"), std::string(" x"), std::string("\n{}"),
        std::string(1, '\0'), std::string(",{}"), std::string("// a comment")}) {
    EXPECT_EQ(parse(whole + rest, row), Status::kMalformed) << rest;
  }
  EXPECT_EQ(parse("\xEF\xBB\xBF" + whole + "\n", row), Status::kOk) << "a byte order mark";
  EXPECT_EQ(parse("x" + whole, row), Status::kMalformed);
}

TEST(PriceJson, ARowWithAFieldTwiceIsSkippedAndTwoListsOfRowsAreRefused) {
  PriceRow row;
  const std::string good = R"({"datetime":"2025-08-17T00:36:00Z","imbalanceprice":5})";
  for (
      const std::string twice :
      {R"({"datetime":"2025-08-17T00:37:00Z","imbalanceprice":5,"imbalanceprice":9})",
       R"({"imbalanceprice":5,"datetime":"2025-08-17T00:37:00Z","imbalanceprice":5})",
       R"({"datetime":"2025-08-17T00:37:00Z","imbalanceprice":null,"imbalanceprice":5})",
       R"({"datetime":"2025-08-17T00:37:00Z","datetime":"2025-08-17T00:35:00Z","imbalanceprice":5})",
       R"({"datetime":"2025-08-17T00:37:00Z","imbalanceprice":5,"imbalancepric\u0065":9})"}) {
    EXPECT_EQ(parse("[" + twice + "]", row), Status::kNoRow) << twice;
    EXPECT_EQ(parse("[" + twice + "," + good + "]", row), Status::kOk) << twice;
    EXPECT_EQ(row.price_centi_eur_per_mwh, 500);
  }
  for (const std::string& twice : {R"({"results":[],"results":[)" + good + "]}",
                                   R"({"results":[)" + good + R"(],"results":[]})"}) {
    EXPECT_EQ(parse(twice, row), Status::kMalformed) << twice;
  }
  EXPECT_EQ(parse(R"({"a":1,"a":2,"results":[)" + good + "]}", row), Status::kOk)
      << "unused fields may have any value";
}

TEST(PriceJson, SkipsRowsThatAreNotRows) {
  PriceRow row;
  EXPECT_EQ(parse(R"({"results":[null, 3, "x", [], {}, {"datetime":5,"imbalanceprice":5},
      {"datetime":"2025-08-17 00:36","imbalanceprice":5},
      {"datetime":"2025-08-17T00:36:00","imbalanceprice":5},
      {"datetime":"2025-02-30T00:36:00Z","imbalanceprice":5},
      {"datetime":"2025-08-17T00:36:00Z","imbalanceprice":"5"},
      {"datetime":"2025-08-17T00:35:00Z","imbalanceprice":5}]})",
                  row),
            Status::kOk);
  EXPECT_EQ(row.minute_utc_s, utc("2025-08-17T00:35:00Z"));
}

TEST(PriceJson, GarbageIsMalformedAndEmptyIsNoRow) {
  PriceRow row;
  for (const char* text : {"", "{", "<html>", "null", "3", "{\"results\": 3}", "{\"rows\": []}",
                           "{\"results\": [{\"dat", "\xff\xfe"}) {
    EXPECT_EQ(parse(text, row), Status::kMalformed) << text;
  }
  EXPECT_EQ(parse("{\"results\": []}", row), Status::kNoRow);
  EXPECT_EQ(parse(std::string(100'000, '['), row), Status::kMalformed);  // no stack overflow
}

TEST(PriceJson, FieldNamesAreConfigurableAndADotLeadsIntoInnerObjects) {
  const PriceFields fields{.rows = "data.rows", .time = "at.utc", .price = "price.value"};
  PriceRow row;
  EXPECT_EQ(parse_newest_price(
                R"({"data":{"rows":[{"at":{"utc":"2025-08-17T00:36:00Z"},"price":{"value":3}}]}})",
                fields, kAsked, row),
            Status::kOk);
  EXPECT_EQ(row.price_centi_eur_per_mwh, 300);
  EXPECT_EQ(parse_newest_price(R"({"data":[]})", fields, kAsked, row), Status::kMalformed);
  EXPECT_EQ(parse_newest_price(R"([{"at":"x","price":3}])", fields, kAsked, row), Status::kNoRow);
}

TEST(PriceJson, TimesMayBeSecondsOrMilliseconds) {
  const std::int64_t minute_utc_s = utc("2025-08-17T00:36:00Z");
  const auto parse_time = [](const std::string& time, PriceRow& row) {
    return parse("[{\"datetime\":" + time + ",\"imbalanceprice\":1}]", row);
  };
  for (const std::string& time :
       {std::to_string(minute_utc_s), std::to_string(minute_utc_s) + "000"}) {
    PriceRow row;
    EXPECT_EQ(parse_time(time, row), Status::kOk) << time;
    EXPECT_EQ(row.minute_utc_s, minute_utc_s) << time;
  }
  for (const char* time : {"-60", "1e300", "-1e300", "1e15", "1755391561", "true"}) {
    PriceRow row;
    EXPECT_EQ(parse_time(time, row), Status::kNoRow) << time;
  }
}

}  // namespace
}  // namespace bess
