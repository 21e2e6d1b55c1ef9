// JSON output and input: numbers to the last digit, and errors that name file and member.
#include "shared/host/json.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "shared/host/json_reader.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

using testing::ElementsAre;

TEST(Json, WritesWhatItIsMadeOf) {
  const int whole[] = {1, -2, 3};
  Json json = Json::object({{"text", "a \"b\" \\ \u00E9\n"},
                            {"on", true},
                            {"list", std::span(whole)},
                            {"inner", Json::object({{"off", false}})}});
  json.set("empty", Json::list());
  EXPECT_EQ(json.line(),
            "{\"text\":\"a \\\"b\\\" \\\\ \u00E9\\n\",\"on\":true,\"list\":[1,-2,3],"
            "\"inner\":{\"off\":false},\"empty\":[]}");
  EXPECT_THAT(json.text(), testing::HasSubstr("\n\t\"list\":\t[1, -2, 3],\n"));
}

TEST(Json, NumbersKeepEveryDigit) {
  EXPECT_EQ(Json(0.1).line(), "0.1");
  EXPECT_EQ(Json(0.1 + 0.2).line(), "0.30000000000000004");
  EXPECT_EQ(Json(1e22).line(), "1e+22");
  EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()).line(), "18446744073709551615");
  EXPECT_EQ(Json(std::numeric_limits<std::int64_t>::min()).line(), "-9223372036854775808");
  EXPECT_EQ(Json(std::int8_t{7}).line(), "7");
  for (const double number : {5e-324, 1.7976931348623157e308, -1.0 / 3, 123456789.123456789}) {
    EXPECT_EQ(Json::parse(Json(number).line()).value().number(), number);
  }
}

TEST(Json, DecimalsAreAsManyAsAsked) {
  EXPECT_EQ(Json(Decimals{1.00005, 4}).line(), "1.0001");
  EXPECT_EQ(Json(Decimals{-3.25, 3}).line(), "-3.250");
  EXPECT_EQ(Json(Decimals{2.5, 0}).line(), "2");
  EXPECT_EQ(Json(Decimals{1.7976931348623157e308, 9}).line().size(), 309U + 10U);
}

TEST(Json, WhatIsNotFiniteIsNull) {
  EXPECT_EQ(Json(std::nan("")).line(), "null");
  EXPECT_EQ(Json(Decimals{std::numeric_limits<double>::infinity(), 2}).line(), "null");
}

TEST(Json, OneWholeValueIsRead) {
  for (const char* text : {"", " ", "{", "{\"a\": 1", "{\"a\": 1} x", "[1,]", "nul", "\xFF\xFE"}) {
    EXPECT_FALSE(Json::parse(text).value().exists()) << text;
  }
  EXPECT_TRUE(Json::parse(" {\"a\": null} \r\n").value()["a"].is_null());
  EXPECT_TRUE(Json::parse("\xEF\xBB\xBF[]").value().is_list());
}

TEST(Json, ValuesOfAnyTypeAreSafeToRead) {
  const Json json = Json::parse(R"({"a": {"b": "c"}, "d": [1, 2.5, "x", false], "e": 4})");
  EXPECT_STREQ(json.value()["a"]["b"].text(), "c");
  EXPECT_FALSE(json.value()["none"]["b"]["c"].exists());
  EXPECT_EQ(json.value()["a"].number(), std::nullopt);
  EXPECT_EQ(json.value()["e"].text(), nullptr);
  std::vector<double> numbers;
  for (const JsonValue item : json.value()["d"]) numbers.push_back(item.number().value_or(-1));
  EXPECT_THAT(numbers, ElementsAre(1, 2.5, -1, -1));
  std::vector<std::string> keys;
  for (const JsonValue item : json.value()) keys.emplace_back(item.key());
  EXPECT_THAT(keys, ElementsAre("a", "d", "e"));
  for (const JsonValue item : json.value()["e"]) ADD_FAILURE() << item.key();
  for (const JsonValue item : JsonValue()) ADD_FAILURE() << item.key();
}

TEST(JsonReader, NamesFileAndMember) {
  const Json json = Json::parse(R"({"text": "x", "number": 2.5, "list": [1, 200]})");
  const JsonReader reader(json.value(), "some.json", "a student file");
  std::int8_t two[2];
  std::int32_t wide[2];
  const std::pair<std::function<void()>, const char*> mistakes[] = {
      {[&] { static_cast<void>(reader.text("none")); }, "some.json none"},
      {[&] { static_cast<void>(reader.text("number")); }, "some.json number"},
      {[&] { static_cast<void>(reader.number("text")); }, "some.json text"},
      {[&] { static_cast<void>(reader.whole("number", 0, 9)); }, "some.json number 0..9"},
      {[&] { reader.wholes("text", std::span(two)); }, "some.json text 2"},
      {[&] { reader.wholes("list", std::span(two)); }, "some.json list 8"},
  };
  for (const auto& [read, codes] : mistakes) EXPECT_THAT(user_error_of(read), Names(codes));
  reader.wholes("list", std::span(wide));
  EXPECT_THAT(wide, ElementsAre(1, 200));
}

}  // namespace
}  // namespace bess
