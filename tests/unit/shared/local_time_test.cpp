// Local time of Brussels from UTC, with the two days per year that have 92 and 100 quarter-hours.
#include "shared/local_time.h"

#include <gtest/gtest.h>

#include <set>

#include "shared/units_and_limits.h"
#include "tests/support/utc_of.h"

namespace bess {
namespace {

class LocalTime : public testing::Test {
 protected:
  void SetUp() override { set_market_time_zone(); }
};

TEST_F(LocalTime, InstantsOfBothOffsetsAndAroundTheChanges) {
  const struct {
    const char* utc;
    int year, month, day, quarter_hour, minute_of_quarter_hour;
  } cases[] = {
      {"2022-12-31T23:00:00Z", 2023, 1, 1, 0, 0},    {"2023-01-01T00:14:00Z", 2023, 1, 1, 4, 14},
      {"2023-06-30T21:59:00Z", 2023, 6, 30, 95, 14}, {"2023-06-30T22:00:00Z", 2023, 7, 1, 0, 0},
      {"2023-03-26T00:59:00Z", 2023, 3, 26, 7, 14},  {"2023-03-26T01:00:00Z", 2023, 3, 26, 12, 0},
      {"2023-10-29T00:00:00Z", 2023, 10, 29, 8, 0},  {"2023-10-29T00:59:00Z", 2023, 10, 29, 11, 14},
      {"2023-10-29T01:00:00Z", 2023, 10, 29, 8, 0},  {"2023-10-29T02:00:00Z", 2023, 10, 29, 12, 0},
      {"2024-02-29T22:59:00Z", 2024, 2, 29, 95, 14}, {"2024-02-29T23:00:00Z", 2024, 3, 1, 0, 0},
  };
  for (const auto& c : cases) {
    const LocalMinute local = local_minute_of(utc_of(c.utc));
    EXPECT_EQ(local.year, c.year) << c.utc;
    EXPECT_EQ(local.month, c.month) << c.utc;
    EXPECT_EQ(local.day, c.day) << c.utc;
    EXPECT_EQ(local.quarter_hour, c.quarter_hour) << c.utc;
    EXPECT_EQ(local.minute_of_quarter_hour, c.minute_of_quarter_hour) << c.utc;
  }
}

TEST_F(LocalTime, DaysHaveNinetyTwoNinetySixOrHundredQuarterHours) {
  const struct {
    const char* midnight_utc;
    int day, quarter_hours, distinct;
  } cases[] = {{"2023-03-24T23:00:00Z", 25, 96, 96},  {"2023-03-25T23:00:00Z", 26, 92, 92},
               {"2023-03-26T22:00:00Z", 27, 96, 96},  {"2023-10-27T22:00:00Z", 28, 96, 96},
               {"2023-10-28T22:00:00Z", 29, 100, 96}, {"2023-10-29T23:00:00Z", 30, 96, 96}};
  for (const auto& c : cases) {
    int quarter_hours = 0;
    std::set<int> distinct;
    std::int64_t at = utc_of(c.midnight_utc);
    ASSERT_NE(local_minute_of(at - 1).day, c.day) << c.midnight_utc;
    for (; local_minute_of(at).day == c.day; at += 60 * kMinutesPerQuarterHour) {
      const LocalMinute local = local_minute_of(at);
      EXPECT_EQ(local.minute_of_quarter_hour, 0);
      distinct.insert(local.quarter_hour);
      ++quarter_hours;
    }
    EXPECT_EQ(quarter_hours, c.quarter_hours) << c.midnight_utc;
    EXPECT_EQ(static_cast<int>(distinct.size()), c.distinct) << c.midnight_utc;
  }
}

TEST_F(LocalTime, FieldsStayInRangeAndFitTogetherForThreeYears) {
  for (std::int64_t at = utc_of("2023-01-01T00:00:00Z"); at < utc_of("2026-01-01T00:00:00Z");
       at += 7 * 60) {
    const LocalMinute local = local_minute_of(at);
    ASSERT_TRUE(local.month >= 1 && local.month <= 12);
    ASSERT_TRUE(local.minute_of_day >= 0 && local.minute_of_day < kMinutesPerDay);
    ASSERT_EQ(local.quarter_hour * kMinutesPerQuarterHour + local.minute_of_quarter_hour,
              local.minute_of_day);
    const CivilTime civil = civil_from_utc(at);
    ASSERT_EQ(utc_from_civil(civil), at);
    // The zone's offset is a whole number of hours, so T_qh is that of UTC.
    ASSERT_EQ(local.minute_of_quarter_hour, civil.minute % kMinutesPerQuarterHour);
  }
}

TEST_F(LocalTime, TheWallClockLeadsBackToItsInstant) {
  for (std::int64_t at = utc_of("2023-01-01T00:00:00Z"); at < utc_of("2026-01-01T00:00:00Z");
       at += 13 * 60) {
    const LocalMinute local = local_minute_of(at);
    const std::int64_t found = utc_from_local({.year = local.year,
                                               .month = local.month,
                                               .day = local.day,
                                               .hour = local.minute_of_day / 60,
                                               .minute = local.minute_of_day % 60,
                                               .second = 0});
    // The second of a repeated hour reads like the first.
    const LocalMinute an_hour_ago = local_minute_of(at - 3'600);
    const bool is_second = an_hour_ago.minute_of_day == local.minute_of_day;
    ASSERT_EQ(found, is_second ? at - 3'600 : at) << utc_text(at).c_str();
  }
  EXPECT_EQ(utc_from_local({2024, 3, 31, 2, 30, 0}), utc_of("2024-03-31T01:30:00Z"))
      << "left out: half an hour behind 02:00, which is 03:00";
  EXPECT_EQ(utc_from_local({2024, 10, 27, 2, 30, 15}), utc_of("2024-10-27T00:30:15Z"));
}

TEST_F(LocalTime, InstantsReadAndWriteAsText) {
  for (const char* text : {"1970-01-01T00:00:00Z", "2000-02-29T23:59:59Z", "2023-10-29T01:00:00Z",
                           "2038-01-19T03:14:08Z", "2100-03-01T00:00:00Z"}) {
    EXPECT_EQ(utc_text(utc_of(text)).view(), text);
  }
  for (const char* text :
       {"2023-10-29T02:30:00+01:00", "2023-10-29T00:00:00-01:30", "2023-10-29T01:30:00.456Z"}) {
    EXPECT_EQ(utc_of(text), utc_of("2023-10-29T01:30Z"));
  }
  std::int64_t utc_s = 0;
  EXPECT_TRUE(parse_utc("2023-10-29 01:30:00.000Z", utc_s, kAlsoBlank));
  EXPECT_EQ(utc_s, utc_of("2023-10-29T01:30Z"));
  for (const char* text :
       {"", "2023", "2023-02-29T00:00:00Z", "2023-01-01T24:00:00Z", "2023-01-01T00:00:00",
        "2023-01-01T00:00:00ZZ", "2023-01-01 00:00:00Z", "2023-13-01T00:00:00Z", "2023-03-26",
        "2023-03-26T01:60:00Z", "2023-03-26T01:02:03+0200", "2023-03-26T01:02:03+99:00",
        "2023-03-26T01:02:03.Z", "2023-03-26T01:02.5Z", "-023-03-26T01:02:03Z"}) {
    EXPECT_FALSE(parse_utc(text, utc_s)) << text;
  }
}

}  // namespace
}  // namespace bess
