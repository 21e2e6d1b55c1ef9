// Minute files: what is written reads back to the same prices.
#include "shared/host/minute_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "shared/host/user_error.h"
#include "tests/support/market_test_support.h"

namespace bess {
namespace {

using testing::HasSubstr;

TEST(MinuteFile, PricesReadBackToTheLastDigit) {
  const MinuteSeries series{0, {-30.258, 0.1 + 0.2, 100}, {-999, 1e-7, std::nan("")}};
  const std::string text = format_minute_csv(series, "");
  EXPECT_THAT(text, HasSubstr("1970-01-01T00:00:00Z,-30.258,-999\n"));
  const MinuteSeries read = parse_minute_csv(text, "written");
  EXPECT_EQ(read.indicative, series.indicative);
  EXPECT_EQ(read.settled[1], 1e-7);
}

TEST(MinuteFile, AByteOrderMarkIsPassedOver) {
  const std::string text =
      "\xEF\xBB\xBFminute_utc,indicative_eur_mwh,settled_eur_mwh\n2023-01-01T00:00:00Z,1,2\n";
  EXPECT_EQ(parse_minute_csv(text, "f").settled.at(0), 2);
  EXPECT_THAT(
      user_error_of([] { (void)parse_minute_csv(std::string_view("\xFF\xFEm\0i\0", 6), "f"); }),
      HasSubstr("UTF-16"));
}

TEST(MinuteFile, NamesTheLineOfEveryMistake) {
  const std::string header = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {"", "f: holds no minutes"},
      {header, "f: holds no minutes"},
      {"time,price\n", "f:1: not a minute file: the header must be"},
      {header + "yesterday,1,2\n", "f:2: "},
      {header + "2023-01-01T00:00:30Z,1,2\n", "f:2: "},
      {header + "2023-01-01T00:00:00Z,abc,2\n", "f:2: "},
      {header + "2023-01-01T00:00:00Z,1,inf\n", "f:2: "},
      {header + "2023-01-01T00:00:00Z,1,2,3\n", "f:2: "},
      {header + "2023-01-01T00:01:00Z,1,2\n2023-01-01T00:00:00Z,1,2\n", "f:3: "},
  };
  for (const auto& [text, message] : mistakes) {
    try {
      static_cast<void>(parse_minute_csv(text, "f"));
      ADD_FAILURE() << text;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), testing::StartsWith(message)) << text;
    }
  }
}

TEST(ParseUtc, TakesASpaceForTheT) {
  std::int64_t with_t = 0;
  std::int64_t with_space = 1;
  EXPECT_TRUE(parse_utc("2023-01-01T00:01:00+01:00", with_t));
  EXPECT_TRUE(parse_utc("2023-01-01 00:01:00+01:00", with_space));
  EXPECT_EQ(with_t, with_space);
  EXPECT_FALSE(parse_utc("2023-01-01 ", with_t));
}

TEST(ParseUtc, PassesOverFractionsOfSeconds) {
  std::int64_t utc_s = 0;
  ASSERT_TRUE(parse_utc("2025-06-15T15:07:00.123456+00:00", utc_s));
  EXPECT_EQ(format_utc(utc_s), "2025-06-15T15:07:00Z");
  ASSERT_TRUE(parse_utc("2025-06-15T15:07:09.000Z", utc_s));
  EXPECT_EQ(format_utc(utc_s), "2025-06-15T15:07:09Z");
  EXPECT_FALSE(parse_utc("2025-06-15T15:07:09.000", utc_s));
  EXPECT_FALSE(parse_utc("2025-06-15T15:07:09.Z", utc_s));
  EXPECT_FALSE(parse_utc("2025-06-15T15:07.5Z", utc_s));
}

}  // namespace
}  // namespace bess
