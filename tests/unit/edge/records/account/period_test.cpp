// Valid and invalid periods.
#include "edge/records/account/day_accounts.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int32_t kMonday = 20'261'123;

void expect_period(const char* text, std::int32_t today, const Period& expected) {
  Period period;
  ASSERT_TRUE(parse_period(text, today, period)) << text;
  EXPECT_EQ(period, expected) << text << ": " << period.first_day << " to " << period.last_day;
}

TEST(Periods, ByTheirNames) {
  expect_period("today", kMonday, {kMonday, kMonday});
  expect_period("yesterday", kMonday, {20'261'122, 20'261'122});
  expect_period("week", kMonday, {kMonday, kMonday});
  expect_period("week", 20'261'122, {20'261'116, 20'261'122});  // a Sunday ends its week
  expect_period("month", kMonday, {20'261'101, kMonday});
  expect_period("last-month", kMonday, {20'261'001, 20'261'031});
}

TEST(Periods, OverTheEndsOfMonthsAndYears) {
  expect_period("yesterday", 20'270'101, {20'261'231, 20'261'231});
  expect_period("yesterday", 20'240'301, {20'240'229, 20'240'229});
  expect_period("week", 20'270'101, {20'261'228, 20'270'101});
  expect_period("last-month", 20'270'115, {20'261'201, 20'261'231});
}

TEST(Periods, ByDate) {
  expect_period("2026-11-01", kMonday, {20'261'101, 20'261'101});
  expect_period("2026-10", kMonday, {20'261'001, 20'261'031});
  expect_period("2024-02", kMonday, {20'240'201, 20'240'229});
  expect_period("2026-10-28..2026-11-03", kMonday, {20'261'028, 20'261'103});
}

TEST(Periods, NothingElse) {
  for (const char* text :
       {"", "tomorrow", "Today", "2026-02-29", "2026-11-31", "2026-13-01", "2026-1-1",
        "2026-11-02..2026-11-01", "2026-11-01..", "..2026-11-01", "2026-11-01...2026-11-02",
        "2026-11-01 ", "1969-12-31", "week ", "2026-13", "2026-1", "2026", "2026-10..2026-11"}) {
    Period period;
    EXPECT_FALSE(parse_period(text, kMonday, period)) << text;
  }
}

}  // namespace
}  // namespace bess
