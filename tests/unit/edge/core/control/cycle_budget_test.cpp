// Full-cycle budget: what counts, when it is used up, and the start of the day.
#include "edge/core/control/cycle_budget.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int32_t kDay = 20'230'326;

TEST(CycleBudget, SumsWhatOrdersMovedInBothDirections) {
  CycleBudget budget(1'000);
  budget.update(kDay, 5'000, true);  // the first reading has no predecessor
  EXPECT_EQ(budget.today().soc_moved_e4, 0);
  budget.update(kDay, 5'900, true);
  budget.update(kDay, 5'000, true);
  EXPECT_EQ(budget.today().soc_moved_e4, 1'800);
  EXPECT_FALSE(budget.is_spent());
  budget.update(kDay, 4'800, true);  // 20 % moved = a tenth of a full cycle
  EXPECT_TRUE(budget.is_spent());
}

TEST(CycleBudget, WhatTheBatteryDoesByItselfDoesNotCount) {
  CycleBudget budget(1'000);
  for (int i = 0; i < 100; ++i) budget.update(kDay, i % 2 == 0 ? 5'000 : 5'010, false);
  EXPECT_EQ(budget.today().soc_moved_e4, 0);
}

TEST(CycleBudget, ALostLinkHidesAStepInSoc) {
  CycleBudget budget(1'000);
  budget.update(kDay, 5'000, true);
  budget.forget_soc();
  budget.update(kDay, 9'000, true);
  EXPECT_EQ(budget.today().soc_moved_e4, 0);
}

TEST(CycleBudget, OpensWithTheNextLocalDay) {
  CycleBudget budget(1'000);
  budget.restore({.local_day = kDay, .soc_moved_e4 = 2'000});
  EXPECT_TRUE(budget.is_spent());
  budget.update(kDay + 1, 5'000, true);
  EXPECT_FALSE(budget.is_spent());
}

TEST(CycleBudget, ZeroMeansNoBudget) {
  CycleBudget budget(0);
  budget.restore({.local_day = kDay, .soc_moved_e4 = 1'000'000});
  EXPECT_FALSE(budget.is_spent());
}

}  // namespace
}  // namespace bess
