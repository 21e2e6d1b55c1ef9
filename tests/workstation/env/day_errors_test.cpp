// The errors of a mean over days: by hand, and on days that follow each other as real ones do.
#include "workstation/env/day_errors.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/tokens.h"
#include "workstation/base/random.h"
#include "workstation/base/student_t.h"

namespace bess {
namespace {

/// Tables of Abramowitz and Stegun, 26.10; of one degree it is the tangent.
TEST(StudentT, IsThatOfTheTables) {
  EXPECT_NEAR(student_t_within(0.95, 1), std::tan(0.95 * std::numbers::pi / 2), 1e-7);
  EXPECT_NEAR(student_t_within(0.95, 2), 4.303, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 3), 3.182, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 4), 2.776, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 11), 2.201, 5e-4);
  EXPECT_NEAR(student_t_within(0.99, 30), 2.750, 5e-4);
  EXPECT_NEAR(student_t_within(0.5, 5), 0.727, 5e-4);
  EXPECT_NEAR(student_t_within(0.95, 100'000), 1.96, 5e-4);
}

/// Two months of two days, 1 3 and 6 10: mean 5, deviations -4 -2 and 1 5, squares 46, sums -6
/// and 6.
TEST(DayErrors, ByHand) {
  const DayErrors errors =
      day_errors({{"2023-01-26", 1}, {"2023-01-27", 3}, {"2023-02-26", 6}, {"2023-02-27", 10}});
  EXPECT_DOUBLE_EQ(errors.plain, std::sqrt(46.0 / 3 / 4));
  EXPECT_DOUBLE_EQ(errors.by_month, std::sqrt(2.0 / 1 * (36 + 36)) / 4);
  EXPECT_EQ(errors.months, 2);
  EXPECT_EQ(errors.days, 4);
  // The same is the deviation of the months' means, 2 and 8, over the root of two.
  EXPECT_DOUBLE_EQ(errors.by_month, std::sqrt(18.0) / std::sqrt(2.0));
}

/// Months of 3, 1 and 2 days, mean 3: sums of deviations -3, 4 and -1.
TEST(DayErrors, OfMonthsOfUnequalLengthByHand) {
  const DayErrors errors = day_errors({{"2023-01-26", 1},
                                       {"2023-01-27", 2},
                                       {"2023-01-28", 3},
                                       {"2023-02-26", 7},
                                       {"2023-03-26", 2},
                                       {"2023-03-27", 3}});
  EXPECT_DOUBLE_EQ(errors.by_month, std::sqrt(1.5 * (9 + 16 + 1)) / 6);
}

TEST(DayErrors, DaysOfAMonthThatAreAllAlikeAreOneWitness) {
  std::vector<DayValue> days;
  for (int month = 1; month <= 4; ++month) {
    for (int day = 26; day <= 30; ++day) {
      days.emplace_back(fmt::format("2023-{:02}-{}", month, day), month % 2 == 0 ? 10.0 : 20.0);
    }
  }
  const DayErrors errors = day_errors(days);
  EXPECT_NEAR(errors.by_month, std::sqrt(100.0 / 3) / 2, 1e-12);              // of four values
  EXPECT_NEAR(errors.plain, std::sqrt(500.0 / 19) / std::sqrt(20.0), 1e-12);  // of twenty
}

/// A January of another year is another month; the order of the days says nothing.
TEST(DayErrors, AMonthIsOfItsYear) {
  EXPECT_EQ(day_errors({{"2023-01-26", 1}, {"2024-01-26", 2}}).months, 2);
  const std::vector<DayValue> days{
      {"2023-01-26", 1}, {"2023-02-26", 6}, {"2023-01-27", 3}, {"2023-02-27", 10}};
  EXPECT_EQ(day_errors(days).months, 2);
  EXPECT_DOUBLE_EQ(day_errors(days).by_month, 3);
}

TEST(DayErrors, WhatCannotBeKnownIsNot) {
  EXPECT_TRUE(std::isnan(day_errors({}).plain));
  const DayErrors one_day = day_errors({{"2023-01-26", 1}});
  EXPECT_TRUE(std::isnan(one_day.plain));
  EXPECT_TRUE(std::isnan(one_day.by_month));
  EXPECT_TRUE(std::isnan(interval_half_width(one_day, 0.95)));
  const DayErrors one_month = day_errors({{"2023-01-26", 1}, {"2023-01-27", 3}});
  EXPECT_DOUBLE_EQ(one_month.plain, 1);
  EXPECT_TRUE(std::isnan(one_month.by_month));
  EXPECT_NEAR(interval_half_width(one_month, 0.95), 12.706, 5e-4);  // all that is known
}

/// Three degrees of four months, nineteen of twenty days; the wider one holds.
TEST(DayErrors, TheIntervalIsTheWiderOne) {
  EXPECT_NEAR(interval_half_width({1, 1, 4, 20}, 0.95), 3.182, 5e-4);
  EXPECT_NEAR(interval_half_width({1, 0.1, 4, 20}, 0.95), 2.093, 5e-4);
  EXPECT_NEAR(interval_half_width({1, 3, 12, 65}, 0.95), 3 * 2.201, 2e-3);
}

TEST(DayErrors, FewMonthsAreSaid) {
  EXPECT_THAT(by_month_meaning(4), Names("4 41 %"));
  EXPECT_THAT(by_month_meaning(12), Names("12"));
}

/// How often each interval of a mean holds the true one, 0.
struct Coverage {
  double plain_68 = 0, plain_95 = 0, clustered_68 = 0, clustered_95 = 0;
};

/// Days of which each keeps `persistence` of the one before, AR(1), over months of 30; only
/// `first_day` and later of each month are judged by. Seeded, so that it repeats.
Coverage coverage_of(double persistence, int months, int first_day, std::uint64_t seed) {
  constexpr int kTrials = 2000;
  constexpr int kDaysOfMonth = 30;
  Random random(seed);
  Coverage held;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<DayValue> days;
    double mean = 0;
    double value = random.normal() / std::sqrt(1 - persistence * persistence);
    for (int month = 1; month <= months; ++month) {
      for (int day = 1; day <= kDaysOfMonth; ++day) {
        value = persistence * value + random.normal();
        if (day < first_day) continue;
        days.emplace_back(fmt::format("2023-{:02}-{:02}", month, day), value);
        mean += value;
      }
    }
    mean /= static_cast<double>(days.size());
    const DayErrors errors = day_errors(days);
    const DayErrors only_plain{errors.plain, std::nan(""), 1, errors.days};
    const auto count = [&](const DayErrors& e, double coverage, double& share) {
      if (std::fabs(mean) < interval_half_width(e, coverage)) share += 1.0 / kTrials;
    };
    count(only_plain, 0.68, held.plain_68);
    count(only_plain, 0.95, held.plain_95);
    count(errors, 0.68, held.clustered_68);
    count(errors, 0.95, held.clustered_95);
  }
  return held;
}

/// Days 26 to 30 of each month, as test days lie: the plain interval of 95 % holds the truth in
/// three of four cases, the clustered one as often as it says, of a dozen months and of four.
TEST(DayErrors, TestDaysThatFollowEachOtherAreCoveredAsNamed) {
  for (const int months : {12, 4}) {
    const Coverage held = coverage_of(0.7, months, 26, 1);
    const std::string told =
        fmt::format("{} months: plain {:.3f} {:.3f}, clustered {:.3f} {:.3f}", months,
                    held.plain_68, held.plain_95, held.clustered_68, held.clustered_95);
    std::printf("%s\n", told.c_str());
    EXPECT_LT(held.plain_95, 0.85) << told;
    EXPECT_LT(held.plain_68, 0.55) << told;
    EXPECT_NEAR(held.clustered_68, 0.68, 0.05) << told;
    EXPECT_NEAR(held.clustered_95, 0.95, 0.025) << told;
  }
}

/// Whole months side by side, as a backtest trades them: neighbours touch, which costs little.
TEST(DayErrors, WholeMonthsAreCoveredAlmostAsNamed) {
  const Coverage held = coverage_of(0.7, 12, 1, 2);
  std::printf("plain %.3f %.3f, clustered %.3f %.3f\n", held.plain_68, held.plain_95,
              held.clustered_68, held.clustered_95);
  EXPECT_LT(held.plain_95, 0.70);
  EXPECT_NEAR(held.clustered_95, 0.95, 0.035);
  EXPECT_NEAR(held.clustered_68, 0.68, 0.06);
}

/// Days that are independent lose nothing but width: the interval holds the truth at least as often
/// as it says.
TEST(DayErrors, IndependentDaysAreCoveredToo) {
  for (const int months : {12, 4}) {
    const Coverage held = coverage_of(0, months, 26, 3);
    EXPECT_NEAR(held.plain_95, 0.95, 0.02);
    EXPECT_GE(held.clustered_95, 0.94);
    EXPECT_LE(held.clustered_95, 0.99);
  }
}

}  // namespace
}  // namespace bess
