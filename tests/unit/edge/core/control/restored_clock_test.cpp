// Log with clock steps between its records: the real time from one reading to the next.
#include "edge/core/loop/cycle_parts.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int32_t kLeadS = 3;

CycleRecord record_at(std::int64_t utc_s, std::int32_t power_w, std::int32_t age_s) {
  CycleRecord record;
  record.utc_s = utc_s;
  record.followed = {.is_judged = true, .power_w = power_w, .age_s = age_s};
  return record;
}

/// From the first to the second reading.
std::int64_t elapsed_s(const CycleRecord& first, const CycleRecord& second) {
  RestoredClock time;
  const std::int64_t first_s = time.steady_s(first, kLeadS);
  EXPECT_EQ(first_s, first.utc_s - kLeadS);
  const std::int64_t second_s = time.steady_s(second, kLeadS);
  EXPECT_EQ(time.ahead_s(), second_s - (second.utc_s - kLeadS));
  return second_s - first_s;
}

TEST(RestoredClock, WithoutAStepIsTheClocks) {
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'320, 4'000, 237)), 120);
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'320, -4'000, 117)), 120);
  // Its price came late.
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'320, -4'000, 77)), 120);
}

TEST(RestoredClock, UnderOneOrderIsThatOfItsAge) {
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'320, 4'000, 307)), 190);
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'440, 4'000, 147)), 30);
  EXPECT_EQ(elapsed_s(record_at(4'800, 4'000, 117), record_at(1'320, 4'000, 240)), 123);
}

TEST(RestoredClock, UnderANewOrderIsAtLeastItsAge) {
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'320, -4'000, 207)), 210);
  EXPECT_EQ(elapsed_s(record_at(4'800, 4'000, 117), record_at(1'320, -4'000, 117)), 120);
}

TEST(RestoredClock, WhatIsNotKnownIsTooLongToBeJudged) {
  EXPECT_GT(elapsed_s(record_at(1'200, 4'000, 117), record_at(1'440, -4'000, 30)), 300);
  EXPECT_GT(elapsed_s(record_at(1'200, 4'000, 117), record_at(4'800, -4'000, 117)), 300);
}

TEST(RestoredClock, WithoutAnOrderIsTheClocks) {
  CycleRecord own = record_at(1'320, 0, 0);
  own.followed.is_judged = false;
  EXPECT_EQ(elapsed_s(record_at(1'200, 4'000, 117), own), 120);
  EXPECT_EQ(elapsed_s(own, record_at(1'440, 4'000, 117)), 120);
}

TEST(RestoredClock, ContinuesAheadAfterAStep) {
  RestoredClock time;
  time.steady_s(record_at(1'200, 4'000, 117), kLeadS);
  time.steady_s(record_at(1'320, 4'000, 307), kLeadS);
  EXPECT_EQ(time.steady_s(record_at(1'440, 4'000, 427), kLeadS), 1'440 - kLeadS + 70);
}

}  // namespace
}  // namespace bess
