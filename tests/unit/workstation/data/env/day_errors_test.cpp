// Errors of a mean over days, by hand.
#include "workstation/data/env/day_errors.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/support/tokens.h"
#include "workstation/base/student_t.h"

namespace bess {
namespace {

/// Tables of Abramowitz and Stegun, 26.10; for one degree it is the tangent.
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
  // Likewise the deviation of the months' means, 2 and 8, over the root of two.
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

/// The same month of another year is another month; the order of the days has no effect.
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
  EXPECT_NEAR(interval_half_width(one_month, 0.95), 12.706, 5e-4);  // everything that is known
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

}  // namespace
}  // namespace bess
