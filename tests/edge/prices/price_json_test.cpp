// The price answer: real shapes, nulls, disorder, the future, nonsense.
#include <gtest/gtest.h>

#include "edge/prices/price_json.h"
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

TEST(PriceJson, TakesTheNewestOfTheApiAnswerInAnyOrder) {
  PriceRow row;
  ASSERT_EQ(parse(R"({"total_count": 4, "results": [
 {"datetime":"2025-08-17T00:00:00+00:00","resolutioncode":"PT1M","imbalanceprice":43.944},
 {"datetime":"2025-08-17T00:36:00+00:00","qualitystatus":"DataIssue","imbalanceprice":-30.258},
 {"datetime":"2025-08-17T00:35:00+00:00","imbalanceprice":1.0}]})",
                  row),
            Status::kOk);
  EXPECT_EQ(row.minute_utc_s, utc("2025-08-17T00:36:00Z"));
  EXPECT_EQ(row.price_centi_eur_per_mwh, -3'026);
}

TEST(PriceJson, PassesOverNullsAndKeepsTheOneBefore) {
  PriceRow row;
  ASSERT_EQ(parse(R"({"results":[{"datetime":"2025-08-17T00:37:00+00:00","imbalanceprice":null},
                     {"datetime":"2025-08-17T02:36:00+02:00","imbalanceprice":7}]})",
                  row),
            Status::kOk);
  EXPECT_EQ(row.minute_utc_s, utc("2025-08-17T00:36:00Z"));  // local offset understood
  EXPECT_EQ(row.price_centi_eur_per_mwh, 700);
}

TEST(PriceJson, UnderstandsABareList) {
  PriceRow row;
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":1.005}])", row),
            Status::kOk);
  EXPECT_EQ(row.price_centi_eur_per_mwh, 100);
}

TEST(PriceJson, RefusesRowsOfTheFutureAndImplausiblePrices) {
  PriceRow row;
  // The row of minute 38 is computed at 00:39 and cannot exist at 00:38.
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:38:00Z","imbalanceprice":1}])", row),
            Status::kNoRow);
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:37:00Z","imbalanceprice":1}])", row), Status::kOk);
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":15000.01}])", row),
            Status::kNoRow);
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":-1e300}])", row),
            Status::kNoRow);
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":1e999}])", row),
            Status::kNoRow);
  EXPECT_EQ(parse(R"([{"datetime":"2025-08-17T00:36:00Z","imbalanceprice":-15000}])", row),
            Status::kOk);
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

TEST(PriceJson, FieldNamesAreConfigurable) {
  PriceFields fields;
  fields.rows = "rows";
  fields.time = "t";
  fields.price = "p";
  PriceRow row;
  EXPECT_EQ(
      parse_newest_price(R"({"rows":[{"t":"2025-08-17T00:36:00Z","p":2}]})", fields, kAsked, row),
      Status::kOk);
  EXPECT_EQ(row.price_centi_eur_per_mwh, 200);
}

TEST(PriceJson, ADotLeadsIntoInnerObjects) {
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
