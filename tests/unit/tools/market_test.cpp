// Simulated market: the published rows over time, in the format of Elia's API, and its file reader.
#include <gmock/gmock.h>

#include "edge/prices/fetch/price_json.h"
#include "shared/scaled_clock.h"
#include "tests/support/utc_of.h"
#include "tools/simulators/market_sim/market_fault.h"
#include "tools/simulators/market_sim/market_view.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFile =
    "# provenance\n"
    "minute_utc,indicative_eur_mwh,settled_eur_mwh\n"
    "2023-03-26T00:13:00Z,10.5,20\n"
    "2023-03-26T00:14:00Z,,20\n"
    "2023-03-26T00:15:00Z,-3.25,30\n";

std::int64_t utc_ns(std::string_view text) { return utc_of(text) * kNanosecondsPerSecond; }

TEST(MarketFaultPlan, StrikesEveryNthRequestWithinItsSpan) {
  MarketFaultPlan plan({.fault = MarketFault::kHttp500, .every = 2, .from_s = 10, .to_s = 20});
  EXPECT_EQ(plan.next(9), MarketFault::kNone);
  EXPECT_EQ(plan.next(10), MarketFault::kNone);
  EXPECT_EQ(plan.next(19.9), MarketFault::kHttp500);
  EXPECT_EQ(plan.next(20), MarketFault::kNone);
  EXPECT_EQ(plan.faults(), 1);
}

TEST(MarketView, RowIsVisibleAtTheEndOfItsMinutePlusLatency) {
  const MarketView view(parse_minute_csv(kFile, "f"), 2.0);
  const RecordsQuery query{.limit = 1};
  EXPECT_THAT(view.records(query, utc_ns("2023-03-26T00:14:01Z")), HasSubstr("\"total_count\":0"));
  EXPECT_THAT(view.records(query, utc_ns("2023-03-26T00:14:02Z")),
              HasSubstr("\"datetime\":\"2023-03-26T00:13:00+00:00\""));
  const std::string later = view.records({.limit = 2}, utc_ns("2023-03-26T00:16:02Z"));
  EXPECT_LT(later.find("00:15:00+00:00"), later.find("00:14:00+00:00"));  // newest first
  EXPECT_THAT(later, HasSubstr("\"imbalanceprice\":null"));
  EXPECT_THAT(later, HasSubstr("\"imbalanceprice\":-3.250"));
}

TEST(MarketView, SettledQuarterHourIsVisibleAfterItsEnd) {
  const MarketView view(parse_minute_csv(kFile, "f"), 0);
  const RecordsQuery query{.dataset = Dataset::kQuarterHours};
  EXPECT_THAT(view.records(query, utc_ns("2023-03-26T00:14:59Z")), HasSubstr("\"total_count\":0"));
  const std::string json = view.records(query, utc_ns("2023-03-26T00:15:00Z"));
  EXPECT_THAT(json, HasSubstr("\"datetime\":\"2023-03-26T00:00:00+00:00\""));
  EXPECT_THAT(json, HasSubstr("\"imbalanceprice\":20.000"));
}

TEST(MarketView, AMinuteWithoutAnyPriceHasNoRow) {
  const MarketView view(parse_minute_csv(std::string(kFile) + "2023-03-26T00:17:00Z,5,30\n", "f"),
                        0);
  const std::string json = view.records({.limit = 20}, utc_ns("2023-03-26T00:18:00Z"));
  EXPECT_THAT(json, HasSubstr("\"total_count\":4"));
  EXPECT_THAT(json, HasSubstr("T00:17:00"));
  EXPECT_THAT(json, ::testing::Not(HasSubstr("T00:16:00")));
}

/// Three days of minutes; the price is the number of the minute.
MinuteSeries three_days() {
  MinuteSeries series{.start_utc_s = utc_ns("2023-03-25T00:00:00Z") / kNanosecondsPerSecond,
                      .indicative = {},
                      .settled = {}};
  for (int minute = 0; minute < 3 * 1'440; ++minute) series.indicative.push_back(minute);
  series.settled = series.indicative;
  return series;
}

TEST(MarketView, PagesFollowEachOther) {
  const MarketView view(three_days(), 0);
  const std::int64_t now_ns = utc_ns("2023-03-27T12:00:00Z");
  const std::string first = view.records({.limit = 100}, now_ns);
  EXPECT_THAT(first, HasSubstr("\"total_count\":1440"));
  EXPECT_THAT(first, HasSubstr("2023-03-27T11:59:00"));
  EXPECT_THAT(first, HasSubstr("2023-03-27T10:20:00"));
  EXPECT_THAT(first, ::testing::Not(HasSubstr("2023-03-27T10:19:00")));
  const std::string second = view.records({.limit = 100, .offset = 100}, now_ns);
  EXPECT_THAT(second, HasSubstr("2023-03-27T10:19:00"));
  EXPECT_THAT(second, HasSubstr("2023-03-27T08:40:00"));
  EXPECT_THAT(view.records({.limit = 100, .offset = 1'440}, now_ns), HasSubstr("\"results\":[]"));
}

TEST(MarketView, PastDaysEndAtMidnightAndGoBackToTheFilesBegin) {
  const MarketView view(three_days(), 0);
  const RecordsQuery query{.dataset = Dataset::kMinutesOfPastDays, .limit = 1};
  for (const char* now : {"2023-03-27T00:00:00Z", "2023-03-27T23:59:00Z"}) {
    const std::string json = view.records(query, utc_ns(now));
    EXPECT_THAT(json, HasSubstr("\"total_count\":2880")) << now;
    EXPECT_THAT(json, HasSubstr("2023-03-26T23:59:00+00:00")) << now;
  }
  EXPECT_THAT(view.records(query, utc_ns("2023-03-25T12:00:00Z")), HasSubstr("\"results\":[]"));
}

}  // namespace
}  // namespace bess
