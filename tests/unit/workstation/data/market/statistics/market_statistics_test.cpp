// Statistics on hand-made series and against the published figures of the real sample.
#include "workstation/data/market/statistics/market_statistics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "shared/host/file.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

using testing::HasSubstr;

TEST(Statistics, QuartilesAndShares) {
  const std::vector<double> prices{-300, 10, 20, kNotPublished, 30, 1200};
  const PriceStatistics result = price_statistics(prices);
  EXPECT_EQ(result.count, 5u);
  EXPECT_EQ(result.quartile_1, 10);
  EXPECT_EQ(result.median, 20);
  EXPECT_EQ(result.quartile_3, 30);
  EXPECT_DOUBLE_EQ(result.mean, 192);
  EXPECT_DOUBLE_EQ(result.share_below_minus_200, 0.2);
  EXPECT_DOUBLE_EQ(result.share_above_1000, 0.2);
  EXPECT_DOUBLE_EQ(result.sign_flip_rate, 1.0 / 3);  // of the three pairs without a gap
}

TEST(Statistics, AutocorrelationOfADailyWave) {
  std::vector<double> prices;
  for (int q = 0; q < 96 * 20; ++q) prices.push_back(std::sin(2 * std::numbers::pi * q / 96));
  const PriceStatistics result = price_statistics(prices);
  EXPECT_NEAR(result.autocorrelation[0], std::cos(2 * std::numbers::pi / 96), 1e-3);
  EXPECT_NEAR(result.autocorrelation[3], 1, 1e-9);
}

TEST(Statistics, SignFlipsSkipGaps) {
  const auto row = [](std::int64_t utc_s, double imbalance_mw) {
    return QuarterHour{.utc_s = utc_s, .price_eur_per_mwh = 1, .system_imbalance_mw = imbalance_mw};
  };
  EXPECT_DOUBLE_EQ(imbalance_sign_flip_rate({row(0, -1), row(900, 1), row(1800, 2), row(9000, -1)}),
                   0.5);
}

/// Two days on either side of PICASSO, at other prices.
TEST(Statistics, EachRegimeHasARowOfItsOwn) {
  MinuteSeries series;
  series.start_utc_s = local_midnight_utc_s({2024, 11, 24});
  series.settled.assign(2 * 1440, -300.0);
  series.settled.resize(5 * 1440, 80.0);
  series.indicative = series.settled;
  const MarketStatistics result = statistics_of_minutes(series);
  ASSERT_EQ(result.regimes.size(), 2U);
  EXPECT_EQ(result.regimes[0].price.count, 2U * 96);
  EXPECT_EQ(result.regimes[0].price.maximum, -300);
  EXPECT_EQ(result.regimes[0].price.share_below_minus_200, 1);
  EXPECT_EQ(result.regimes[1].price.count, 3U * 96);
  EXPECT_EQ(result.regimes[1].price.minimum, 80);
  EXPECT_EQ(result.regimes[1].price.median, 80);
  EXPECT_THAT(format_statistics_text(result), Names("PICASSO 288 80.00"));
  series.start_utc_s = local_midnight_utc_s({2025, 1, 1});
  ASSERT_EQ(statistics_of_minutes(series).regimes.size(), 1U);
}

TEST(Statistics, ClockChangesOfAYear) {
  MinuteSeries series;
  series.start_utc_s = local_midnight_utc_s({2023, 1, 1});
  series.settled.assign(365 * 1440, 1.0);
  series.indicative = series.settled;
  const MarketStatistics result = statistics_of_minutes(series);
  ASSERT_EQ(result.clock_changes.size(), 2u);
  EXPECT_EQ(result.clock_changes[0].day.month, 3);
  EXPECT_EQ(result.clock_changes[0].quarter_hours, 92);
  EXPECT_EQ(result.clock_changes[1].day.day, 29);
  EXPECT_EQ(result.clock_changes[1].quarter_hours, 100);
}

TEST(Statistics, TextAndJson) {
  MinuteSeries series;
  series.settled.assign(45, 100.0);
  series.indicative.assign(45, 90.0);
  series.indicative[20] = kNotPublished;
  const MarketStatistics result = statistics_of_minutes(series);
  EXPECT_THAT(format_statistics_text(result), testing::Not(HasSubstr("nan")));
  const std::string json = format_statistics_json(result);
  EXPECT_THAT(json, HasSubstr("\"settled_eur_per_mwh_median\":100"));
  EXPECT_THAT(json, HasSubstr("\"autocorrelation\":{\"1\":null"));  // a constant has none
  EXPECT_THAT(json, HasSubstr("{\"minute\":5,\"rows\":2,\"error_eur_per_mwh_median\":10,"));
  EXPECT_THAT(
      json,
      HasSubstr("{\"from_utc\":\"1970-01-01T00:20:00Z\",\"until_utc\":\"1970-01-01T00:21:00Z\"}"));
}

TEST(Statistics, RealQuarterHoursOf2023) {
  const std::string sample = "elia_quarter_hour_2023-01_2023-05.csv.gz";
  const MarketStatistics result = statistics_of_quarter_hours(
      read_quarter_hour_files({real_sample(sample).string()}).quarter_hours);
  EXPECT_EQ(result.price.count, 13'650u);
  EXPECT_NEAR(result.price.quartile_1, 34.84, 0.01);
  EXPECT_NEAR(result.price.median, 137.45, 0.01);
  EXPECT_NEAR(result.price.quartile_3, 209.97, 0.01);
  EXPECT_NEAR(result.price.mean, 117.78, 0.01);
  EXPECT_NEAR(result.price.share_below_minus_200, 0.0236, 0.0001);
  EXPECT_EQ(std::lround(result.price.share_above_1000 * 13'650), 16);
  EXPECT_NEAR(result.price.autocorrelation[0], 0.60, 0.005);
  EXPECT_NEAR(result.price.autocorrelation[3], 0.16, 0.005);
  EXPECT_NEAR(result.imbalance_sign_flip_rate.value_or(0), 0.288, 0.001);
}

}  // namespace
}  // namespace bess
