// Minute files: what is written reads back to the same prices.
#include "shared/host/minute_file.h"

#include <gmock/gmock.h>

#include <cmath>

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
