// Minutes on real quarter-hours.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/market_test_support.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/statistics/market_statistics.h"

namespace bess {
namespace {

std::vector<QuarterHour> three_quarter_hours() {
  // ods047, 22 April 2023 and around; the last follows after a gap of one quarter-hour
  return {{0, 216.28, -24.737, 0.0, 216.28, 6.15},
          {900, 203.75, -220.803, 1.28, 202.47, -184.04},
          {2700, 6.78, 71.283, 0.0, 104.6, 6.78}};
}

TEST(Reconstruct, EndsOnTheSettledPriceAndLeavesGapsEmpty) {
  const MinuteSeries series = minutes_on_quarter_hours(three_quarter_hours(), 1);
  ASSERT_EQ(series.size(), 60u);
  EXPECT_EQ(series.indicative[14], 216.28);
  EXPECT_EQ(series.indicative[29], 203.75);
  EXPECT_EQ(series.indicative[59], 6.78);
  for (std::size_t m = 30; m < 45; ++m) {
    EXPECT_TRUE(std::isnan(series.indicative[m]) && std::isnan(series.settled[m]));
  }
}

TEST(Reconstruct, WithoutImbalanceThereAreNoIndicativePrices) {
  auto rows = three_quarter_hours();
  rows[1].system_imbalance_mw = kNotPublished;
  const MinuteSeries series = minutes_on_quarter_hours(rows, 1);
  EXPECT_TRUE(std::isnan(series.indicative[20]));
  EXPECT_EQ(series.settled[20], 203.75);
}

TEST(Reconstruct, WithoutMarginalPricesThePathStillEndsOnTheSettledPrice) {
  auto rows = three_quarter_hours();
  for (QuarterHour& row : rows) {
    row.marginal_incremental_eur_per_mwh = kNotPublished;
    row.marginal_decremental_eur_per_mwh = kNotPublished;
  }
  const MinuteSeries series = minutes_on_quarter_hours(rows, 1);
  EXPECT_EQ(series.indicative[29], 203.75);
  for (std::size_t m = 0; m < 30; ++m) EXPECT_TRUE(std::isfinite(series.indicative[m]));
}

TEST(Reconstruct, RealQuarterHoursConvergeLikeTheRealMinuteDays) {
  const std::string sample = "elia_quarter_hour_2023-01_2023-05.csv.gz";
  const auto rows = read_quarter_hour_files({real_sample(sample).string()}).quarter_hours;
  const MinuteSeries series = minutes_on_quarter_hours(rows, 7);
  const ConvergenceByMinute convergence = convergence_by_minute(series);
  // 0.7 of the smaller to 1.3 of the larger median of the two ods161 days
  EXPECT_GE(convergence[0].median_error, 0.7 * 32.0);
  EXPECT_LE(convergence[0].median_error, 1.3 * 80.8);
  EXPECT_GE(convergence[4].median_error, 0.7 * 9.4);
  EXPECT_LE(convergence[4].median_error, 1.3 * 21.7);
  EXPECT_GE(convergence[7].median_error, 0.7 * 7.5);
  EXPECT_LE(convergence[7].median_error, 1.3 * 17.0);
  EXPECT_LE(convergence[12].median_error, 2.5);
  EXPECT_EQ(convergence[14].mean_error, 0);
  EXPECT_NEAR(price_statistics(settled_by_quarter_hour(series)).median, 137.45, 0.01);
}

}  // namespace
}  // namespace bess
