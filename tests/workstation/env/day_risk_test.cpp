#include "workstation/env/day_risk.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bess {
namespace {

TEST(DayRisk, ByHand) {
  const std::vector<double> days{3, -1, 2, -2, 8};
  const DayRisk risk = day_risk(days);
  EXPECT_DOUBLE_EQ(risk.win_rate, 0.6);
  EXPECT_DOUBLE_EQ(risk.sortino.value(), 2 / std::sqrt(5.0 / 5));
  EXPECT_DOUBLE_EQ(risk.value_at_risk, 1.8) << "a fifth of the way from -2 to -1";
  EXPECT_DOUBLE_EQ(risk.drawdown, 2);
  EXPECT_EQ(cumulative(days), (std::vector<double>{3, 2, 4, 2, 10}));
  EXPECT_EQ(below_peak(cumulative(days)), (std::vector<double>{0, -1, 0, -2, 0}));
}

TEST(DayRisk, DaysThatNeverLose) {
  const DayRisk risk = day_risk(std::vector<double>{5, 1, 9});
  EXPECT_DOUBLE_EQ(risk.win_rate, 1);
  EXPECT_FALSE(risk.sortino.has_value());
  EXPECT_LT(risk.value_at_risk, 0);
  EXPECT_EQ(risk.drawdown, 0);
}

TEST(DayRisk, AFallFromTheBeginningCounts) {
  EXPECT_DOUBLE_EQ(day_risk(std::vector<double>{-4, 1, -2}).drawdown, 5);
  EXPECT_DOUBLE_EQ(day_risk(std::vector<double>{-4, 1, -2}).win_rate, 1.0 / 3);
}

TEST(DayRisk, OneDayAndADayOfNothing) {
  const DayRisk risk = day_risk(std::vector<double>{0.0});
  EXPECT_EQ(risk.win_rate, 0) << "nothing is no win";
  EXPECT_EQ(risk.value_at_risk, 0);
  EXPECT_FALSE(std::signbit(risk.value_at_risk));
  EXPECT_FALSE(std::signbit(risk.drawdown));
  EXPECT_FALSE(risk.sortino.has_value());
  EXPECT_THROW(day_risk({}), std::logic_error);
}

TEST(DayRisk, GainsAreByDayAndByCapacity) {
  Evaluation a;
  a.capacity_mwh = 8;
  a.days = {{"2023-01-26", 16, 0, 0, 0}, {"2023-01-27", -8, 0, 0, 0}};
  Evaluation b = a;
  b.days[0].profit_eur = 8;
  EXPECT_EQ(daily_profits(a), (std::vector<double>{2, -1}));
  EXPECT_EQ(daily_gains(a, b), (std::vector<double>{1, 0}));
  b.days.pop_back();
  EXPECT_THROW(daily_gains(a, b), std::logic_error);
}

}  // namespace
}  // namespace bess
