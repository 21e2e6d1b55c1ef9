#include "workstation/data/env/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bess {
namespace {

TEST(Drawdown, ByHand) {
  const std::vector<double> days{3, -1, 2, -2, 8};
  EXPECT_EQ(cumulative(days), (std::vector<double>{3, 2, 4, 2, 10}));
  EXPECT_EQ(below_peak(cumulative(days)), (std::vector<double>{0, -1, 0, -2, 0}));
  EXPECT_EQ(drawdown(days), 2);
}

TEST(Drawdown, AFallFromTheBeginningCounts) {
  EXPECT_EQ(drawdown(std::vector<double>{-4, 1, -2}), 5);
}

TEST(Drawdown, DaysThatNeverLoseHaveNone) {
  for (const std::vector<double>& days :
       {std::vector<double>{5, 1, 9}, std::vector<double>{0}, std::vector<double>{}}) {
    EXPECT_EQ(drawdown(days), 0);
    EXPECT_FALSE(std::signbit(drawdown(days)));
  }
}

TEST(Drawdown, ProfitsAreByDayAndByCapacity) {
  Evaluation a;
  a.capacity_mwh = 8;
  a.days = {{"2023-01-26", 16, 0, 0, 0}, {"2023-01-27", -8, 0, 0, 0}};
  EXPECT_EQ(daily_profits(a), (std::vector<double>{2, -1}));
}

}  // namespace
}  // namespace bess
