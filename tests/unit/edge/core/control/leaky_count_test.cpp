// Detection time of intermittent faults, and what is forgiven.
#include "edge/core/supervision/leaky_count.h"

#include <gtest/gtest.h>

#include <utility>

namespace bess {
namespace {

/// Readings until it is found when every `period`th one is bad, the first among them; 0: never.
int readings_to_find(int period) {
  LeakyCount count;
  for (int reading = 0; reading < 1'000; ++reading) {
    if (reading % period == 0) {
      count.bad();
    } else {
      count.good();
    }
    if (count.is_found()) return reading + 1;
  }
  return 0;
}

TEST(LeakyCount, FindsWhatIsBadAtLeastEveryThirdTimeAndForgivesLess) {
  for (const auto& [period, readings] :
       {std::pair{1, 2}, {2, 3}, {3, 7}, {4, 0}, {5, 0}, {6, 0}, {60, 0}}) {
    EXPECT_EQ(readings_to_find(period), readings) << period;
  }
}

TEST(LeakyCount, OneBadReadingIsNeverEnough) {
  LeakyCount count;
  count.bad();
  EXPECT_FALSE(count.is_found());
  for (int good = 0; good < 3; ++good) count.good();
  EXPECT_EQ(count, LeakyCount{});
  count.good();
  EXPECT_EQ(count.level, 0) << "a long good period is no credit";
}

TEST(LeakyCount, WhatWasBadForADayIsForgivenLikeWhatWasBadTwice) {
  LeakyCount day, twice;
  for (int reading = 0; reading < 1'440; ++reading) day.bad();
  twice.bad();
  twice.bad();
  EXPECT_EQ(day, twice);
  day.good();
  EXPECT_TRUE(day.is_found());
  day.good();
  EXPECT_FALSE(day.is_found());
}

TEST(LeakyCount, ForgetsItsLevel) {
  LeakyCount count;
  count.bad();
  count.forget();
  EXPECT_EQ(count.level, 0);
}

}  // namespace
}  // namespace bess
