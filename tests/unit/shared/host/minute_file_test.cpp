// Minute files: what is written reads back to the same prices.
#include "shared/host/minute_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(MinuteFile, PricesReadBackToTheLastDigit) {
  const MinuteSeries series{0, {-30.258, 0.1 + 0.2, 100}, {-999, 1e-7, std::nan("")}};
  const std::string text = format_minute_csv(series, "");
  EXPECT_THAT(text, testing::HasSubstr("1970-01-01T00:00:00Z,-30.258,-999\n"));
  const MinuteSeries read = parse_minute_csv(text, "written");
  EXPECT_EQ(read.indicative, series.indicative);
  EXPECT_EQ(read.settled[1], 1e-7);
}

TEST(MinuteFile, AByteOrderMarkIsSkipped) {
  const std::string text =
      "\xEF\xBB\xBFminute_utc,indicative_eur_mwh,settled_eur_mwh\n2023-01-01T00:00:00Z,1,2\n";
  EXPECT_EQ(parse_minute_csv(text, "f").settled.at(0), 2);
  EXPECT_THAT(
      user_error_of([] { (void)parse_minute_csv(std::string_view("\xFF\xFEm\0i\0", 6), "f"); }),
      Names("f UTF-16"));
}

TEST(MinuteFile, EmptyPricesCommentsAndGapsAreMissing) {
  const MinuteSeries series = parse_minute_csv(
      "# provenance\n"
      "minute_utc,indicative_eur_mwh,settled_eur_mwh\r\n"
      "\n"
      "2023-03-26T00:13:00Z,10.5,20\r\n"
      "2023-03-26T00:14:00Z,,20\n"
      "2023-03-26 01:16:00+01:00,-3.25,\n",
      "f");
  ASSERT_EQ(series.size(), 4U);
  EXPECT_EQ(series.indicative[0], 10.5);
  EXPECT_TRUE(std::isnan(series.indicative[1]));
  EXPECT_FALSE(series.is_empty(1));
  EXPECT_TRUE(series.is_empty(2));
  EXPECT_EQ(series.indicative[3], -3.25);
  EXPECT_TRUE(std::isnan(series.settled[3]));
}

TEST(MinuteFile, EveryMistakeNamesItsLine) {
  const std::string header = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {"", "f"},
      {header, "f"},
      {header + "2023-01-01T00:00:00Z,,\n", "f"},
      {"time,price\n", "f:1 minute_utc"},
      {header + "yesterday,1,2\n", "f:2 \"yesterday,1,2\""},
      {header + "2023-01-01T00:00:30Z,1,2\n", "f:2"},
      {header + "2023-01-01T00:00:00Z,abc,2\n", "f:2 indicative"},
      {header + "2023-01-01T00:00:00Z,1,inf\n", "f:2 settled"},
      {header + "2023-01-01T00:00:00Z,1,2,3\n", "f:2"},
      {header + "#\n2023-01-01T00:01:00Z,1,2\n2023-01-01T00:00:00Z,1,2\n", "f:4"},
      {header + "2023-01-01T00:00:00Z,1,2\n2073-01-01T00:00:00Z,1,2\n",
       "f:3 2073-01-01T00:00:00Z 40"},
  };
  for (const auto& mistake : mistakes) {
    EXPECT_THAT(user_error_of([&] { static_cast<void>(parse_minute_csv(mistake.first, "f")); }),
                Names(mistake.second));
  }
}

}  // namespace
}  // namespace bess
