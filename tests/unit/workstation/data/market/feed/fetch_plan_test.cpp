#include "workstation/data/market/feed/elia_fetch.h"

#include <gmock/gmock.h>

#include "shared/host/http_client.h"
#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr std::int64_t kFetchTime_s = 1'750'000'000;  // 15 June 2025, 17:06 local

std::vector<std::string> described(const FetchSpan& span) {
  std::vector<std::string> lines;
  for (const FetchWindow& window : plan_fetch(span, kFetchTime_s)) {
    const auto hour = [](std::int64_t utc_s) {
      return std::string(utc_text(utc_s).view().substr(0, 13));
    };
    lines.push_back(window.dataset + " " + hour(window.from_utc_s) + " " +
                    hour(window.until_utc_s) + (window.settles_later ? " later" : ""));
  }
  return lines;
}

TEST(FetchPlan, CutsByMonthAndChangesDatasetsOn22May2024) {
  EXPECT_THAT(described({{2024, 4, 30}, {2024, 6, 1}}),
              testing::ElementsAre(
                  "ods046 2024-04-29T22 2024-04-30T22", "ods047 2024-04-29T22 2024-04-30T22",
                  "ods046 2024-04-30T22 2024-05-21T22", "ods047 2024-04-30T22 2024-05-21T22",
                  "ods133 2024-05-21T22 2024-05-31T22", "ods134 2024-05-21T22 2024-05-31T22",
                  "ods133 2024-05-31T22 2024-06-01T22", "ods134 2024-05-31T22 2024-06-01T22"));
}

TEST(FetchPlan, TodayHasItsOwnDatasetsAndTomorrowNone) {
  EXPECT_THAT(described({{2025, 6, 14}, {2025, 7, 31}}),
              testing::ElementsAre("ods133 2025-06-13T22 2025-06-14T22 later",
                                   "ods134 2025-06-13T22 2025-06-14T22 later",
                                   "ods161 2025-06-14T22 2025-06-15T22 later",
                                   "ods162 2025-06-14T22 2025-06-15T22 later"));
}

TEST(FetchPlan, RefusesEmptySpans) {
  EXPECT_THAT(user_error_of([] {
                (void)plan_fetch({{2023, 2, 1}, {2023, 1, 1}}, kFetchTime_s);
              }),
              Names("--from 2023-02-01 --to 2023-01-01"));
  EXPECT_THAT(user_error_of([] {
                (void)plan_fetch({{2026, 2, 1}, {2026, 3, 1}}, kFetchTime_s);
              }),
              Names("2026-02-01"));
}

TEST(WaitSeconds, EveryFormServersUse) {
  EXPECT_EQ(wait_seconds("120", 1e9), 120);
  EXPECT_EQ(wait_seconds("1750000030", kFetchTime_s), 30);
  EXPECT_EQ(wait_seconds("2025-06-15 15:07:00+00:00", kFetchTime_s), 20);
  EXPECT_EQ(wait_seconds("Sun, 15 Jun 2025 15:07:00 GMT", kFetchTime_s), 20);
  EXPECT_EQ(wait_seconds("Sun, 15 Jun 2025 15:00:00 GMT", kFetchTime_s), 0);
  EXPECT_EQ(wait_seconds("-5", kFetchTime_s), 0);
  for (const char* far : {"99999999999999999999", "1e999", "inf", "86401",
                          "2026-06-15 00:00:00+00:00", "Fri, 31 Dec 9999 23:59:59 GMT"}) {
    EXPECT_EQ(wait_seconds(far, kFetchTime_s), kWaitMax_s) << far;
  }
  EXPECT_EQ(wait_seconds("nan", kFetchTime_s), std::nullopt);
  EXPECT_THAT(describe_wait(7), Names("7"));
  EXPECT_THAT(describe_wait(7'200), Names("120"));
  EXPECT_EQ(wait_seconds("soon", kFetchTime_s), std::nullopt);
  EXPECT_EQ(wait_seconds("", kFetchTime_s), std::nullopt);
}

}  // namespace
}  // namespace bess
