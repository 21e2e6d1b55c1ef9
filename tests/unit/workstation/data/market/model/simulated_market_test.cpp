// Simulated market against the real one. Targets: figures of Elia's ods047, 1 January to 23 May
// 2023 (13,650 quarter-hours), and of the two ods161 days 6 September 2024 and 8 April 2025.
#include "workstation/data/market/model/simulated_market.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "shared/local_time.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/statistics/market_statistics.h"

namespace bess {
namespace {

struct Target {
  const char* name;
  double real, low, high;
};

Target within(const char* name, double real, double tolerance) {
  return {name, real, real - tolerance, real + tolerance};
}
Target within_factor(const char* name, double real, double factor) {
  return {name, real, real / factor, real * factor};
}

constexpr std::array<int, 5> kMinutesCompared{0, 2, 4, 7, 10};
constexpr double kLateMinuteErrorMax = 2.5;  ///< from minute 12 on; the two days have 2.1 and 0.8
/// Median absolute error to the settled price: 6 September 2024, 8 April 2025.
constexpr std::array<std::array<double, 2>, 5> kMinuteErrors{
    {{80.8, 32.0}, {41.9, 8.3}, {21.7, 9.4}, {17.0, 7.5}, {4.3, 2.0}}};

UtcSpan year_2023() {
  return {local_midnight_utc_s({2023, 1, 1}), local_midnight_utc_s({2024, 1, 1})};
}

void expect_in(const Target& target, double simulated) {
  EXPECT_TRUE(simulated >= target.low && simulated <= target.high)
      << target.name << ": " << simulated << ", real " << target.real;
}

void compare_prices(const PriceStatistics& price) {
  expect_in(within("first quartile", 34.84, 3.484), price.quartile_1);
  expect_in(within("median", 137.45, 13.745), price.median);
  expect_in(within("third quartile", 209.97, 20.997), price.quartile_3);
  expect_in(within_factor("share below -200", 0.0236, 1.5), price.share_below_minus_200);
  expect_in(within_factor("share above 1000", 0.00117, 1.5), price.share_above_1000);
  constexpr std::array<double, 4> kReal{0.60, 0.43, 0.37, 0.16};
  for (std::size_t i = 0; i < kReal.size(); ++i) {
    const std::string name = fmt::format("autocorrelation lag {}", kAutocorrelationLags[i]);
    expect_in(within(name.c_str(), kReal[i], 0.1), price.autocorrelation[i]);
  }
}

void compare_convergence(const ConvergenceByMinute& convergence) {
  for (std::size_t i = 0; i < kMinutesCompared.size(); ++i) {
    const auto [larger, smaller] = kMinuteErrors[i];
    const std::string name = fmt::format("median error, minute {} (mean day)", kMinutesCompared[i]);
    expect_in({name.c_str(), (larger + smaller) / 2, 0.7 * smaller, 1.3 * larger},
              convergence[static_cast<std::size_t>(kMinutesCompared[i])].median_error);
  }
  for (const std::size_t minute : {12u, 13u, 14u}) {
    EXPECT_LE(convergence[minute].median_error, kLateMinuteErrorMax);
  }
}

TEST(SimulatedMarket, LooksLikeTheRealOne) {
  for (const std::uint64_t seed : {1, 17, 2023}) {
    SCOPED_TRACE(seed);
    const auto quarter_hours = simulate_quarter_hours(year_2023(), seed);
    const MinuteSeries series = minutes_on_quarter_hours(quarter_hours, seed);
    compare_prices(price_statistics(settled_by_quarter_hour(series)));
    expect_in(within("sign flips of the imbalance", 0.288, 0.05),
              imbalance_sign_flip_rate(quarter_hours));
    compare_convergence(convergence_by_minute(series));
  }
}

TEST(SimulatedMarketYear, ObeysTheFormulaInEveryQuarterHour) {
  const auto quarter_hours = simulate_quarter_hours(year_2023(), 9);
  ASSERT_EQ(quarter_hours.size(), 365u * 96u);
  for (std::size_t i = 1; i < quarter_hours.size(); ++i) {
    const QuarterHour& row = quarter_hours[i];
    ASSERT_EQ(row.utc_s - quarter_hours[i - 1].utc_s, 900);
    ASSERT_EQ(row.price_eur_per_mwh,
              in_cents(imbalance_price_eur_per_mwh(
                  {row.system_imbalance_mw, quarter_hours[i - 1].system_imbalance_mw,
                   row.marginal_incremental_eur_per_mwh, row.marginal_decremental_eur_per_mwh})));
  }
}

TEST(SimulatedMarketYear, HasDailyAndSeasonalShape) {
  const auto quarter_hours = simulate_quarter_hours(year_2023(), 11);
  double evening = 0, noon = 0, winter = 0, summer = 0;
  for (const QuarterHour& row : quarter_hours) {
    const LocalMinute local = local_minute_of(row.utc_s);
    const int hour = local.quarter_hour / 4;
    if (hour >= 18 && hour < 20) evening += row.system_imbalance_mw / (365 * 8);
    if (hour >= 12 && hour < 14) noon += row.system_imbalance_mw / (365 * 8);
    if (local.month <= 2) winter += row.marginal_incremental_eur_per_mwh / (59 * 96);
    if (local.month == 6 || local.month == 7) {
      summer += row.marginal_incremental_eur_per_mwh / (61 * 96);
    }
  }
  EXPECT_GT(noon - evening, 40);   // MW: real sample 2023, local 12-14 h against 18-20 h: 84
  EXPECT_GT(winter - summer, 20);  // EUR/MWh; the extrapolated season
}

TEST(SimulatedMarketYear, SeedDecidesEverything) {
  const UtcSpan week{local_midnight_utc_s({2023, 3, 20}), local_midnight_utc_s({2023, 3, 27})};
  const auto first = simulate_quarter_hours(week, 5);
  const auto again = simulate_quarter_hours(week, 5);
  const auto other = simulate_quarter_hours(week, 6);
  ASSERT_EQ(first.size(), 7u * 96u - 4u);  // 26 March has 92 quarter-hours
  int different = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].price_eur_per_mwh, again[i].price_eur_per_mwh);
    if (first[i].price_eur_per_mwh != other[i].price_eur_per_mwh) ++different;
  }
  EXPECT_GT(different, 600);
}

TEST(SimulatedMarketYear, PricesAreWholeCents) {
  const UtcSpan period{local_midnight_utc_s({2023, 1, 1}), local_midnight_utc_s({2023, 1, 8})};
  const MinuteSeries series = minutes_on_quarter_hours(simulate_quarter_hours(period, 1), 1);
  for (std::size_t m = 0; m < series.size(); ++m) {
    for (const double price : {series.indicative[m], series.settled[m]}) {
      EXPECT_EQ(price, std::round(100 * price) / 100);
    }
  }
}

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

}  // namespace
}  // namespace bess
