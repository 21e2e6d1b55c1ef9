// Small parts of the edge: built-in student, ticks, log lines.
#include <gtest/gtest.h>

#include "edge/core/control/policy.h"
#include "edge/core/loop/control_loop.h"
#include "edge/records/log/log_text.h"

namespace bess {
namespace {

TEST(BuiltInStudent, ComputesEverySelfCheckOfItsHeader) {
  EXPECT_GT(student_self_check_count(), 0);
  EXPECT_EQ(count_student_self_check_failures(), 0);
}

TEST(Ticks, AreOnTheTwoMinuteGridStrictlyAhead) {
  EXPECT_EQ(next_tick_utc_s(0), 120);
  EXPECT_EQ(next_tick_utc_s(119), 120);
  EXPECT_EQ(next_tick_utc_s(120), 240);
}

}  // namespace
}  // namespace bess
