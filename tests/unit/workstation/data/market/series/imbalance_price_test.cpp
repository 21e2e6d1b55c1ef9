// Price formula: cases from published rows (ods047), and all 13,650 of them if the sample is
// present.
#include "workstation/data/market/series/imbalance_price.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/market_files.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

TEST(ImbalancePrice, SidesAndDeadBand) {
  EXPECT_DOUBLE_EQ(imbalance_price_eur_per_mwh({-75.8, 71.3, 107.93, 46.72}), 107.93);
  EXPECT_DOUBLE_EQ(imbalance_price_eur_per_mwh({71.3, -41.3, 104.6, 6.78}), 6.78);
  EXPECT_DOUBLE_EQ(imbalance_price_eur_per_mwh({0, 0, 104.6, 6.78}), 6.78);  // 0 counts as long
  EXPECT_DOUBLE_EQ(alpha_eur_per_mwh({-150, -900, 100, 50}), 0);
  EXPECT_GT(alpha_eur_per_mwh({-150.001, -900, 100, 50}), 0);
}

TEST(ImbalancePrice, AlphaIsTemperedByTheMarginalPrice) {
  const double full = 200 / (1 + std::exp((450 - 600) / 65.0));
  EXPECT_NEAR(alpha_eur_per_mwh({-600, -600, 200, 50}), full, 1e-12);
  EXPECT_NEAR(alpha_eur_per_mwh({-600, -600, 300, 50}), full / 2, 1e-12);
  EXPECT_DOUBLE_EQ(alpha_eur_per_mwh({-600, -600, 400, 50}), 0);
  EXPECT_NEAR(alpha_eur_per_mwh({600, 600, 100, 0}), full, 1e-12);
  EXPECT_NEAR(alpha_eur_per_mwh({600, 600, 100, -100}), full / 2, 1e-12);
  EXPECT_DOUBLE_EQ(alpha_eur_per_mwh({600, 600, 100, -200}), 0);
}

TEST(ImbalancePrice, RealQuarterHoursOf2023) {
  const std::string sample = "elia_quarter_hour_2023-01_2023-05.csv.gz";
  const auto rows = read_quarter_hour_files({real_sample(sample).string()}).quarter_hours;
  ASSERT_EQ(rows.size(), 13'650u);
  int alpha_right = 0;
  int price_right = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const ImbalanceState state{rows[i].system_imbalance_mw, rows[i - 1].system_imbalance_mw,
                               rows[i].marginal_incremental_eur_per_mwh,
                               rows[i].marginal_decremental_eur_per_mwh};
    if (std::abs(alpha_eur_per_mwh(state) - rows[i].alpha_eur_per_mwh) <= 0.02) ++alpha_right;
    const double price = imbalance_price_eur_per_mwh(state);
    if (std::abs(price - rows[i].price_eur_per_mwh) <= 0.03) ++price_right;
  }
  EXPECT_EQ(alpha_right, 13'648);  // of 13,649
  EXPECT_GE(price_right, 13'648);
}

TEST(LocalDate, ReadsOnlyRealDates) {
  EXPECT_EQ(parse_local_date("2024-02-29", "--from"), (LocalDate{2024, 2, 29}));
  for (const char* bad : {"2023-02-29", "2023-1-1", "20230101", "2023-01-01T00", ""}) {
    EXPECT_THAT(user_error_of([&] { (void)parse_local_date(bad, "--from"); }),
                Names(fmt::format("--from \"{}\"", bad)));
  }
}

TEST(LocalDate, MidnightsFollowTheClock) {
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 1, 1})), "2022-12-31T23:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 3, 26})), "2023-03-25T23:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 3, 27})), "2023-03-26T22:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 10, 30})), "2023-10-29T23:00:00Z");
}

TEST(LocalDate, DaysCrossMonthsAndYears) {
  EXPECT_EQ(add_days({2023, 12, 31}, 1), (LocalDate{2024, 1, 1}));
  EXPECT_EQ(add_days({2024, 3, 1}, -1), (LocalDate{2024, 2, 29}));
  EXPECT_EQ(format_local_date({2024, 3, 1}), "2024-03-01");
}

}  // namespace
}  // namespace bess
