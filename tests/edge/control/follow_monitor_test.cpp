// What counts as following an order, as ignoring it, and as going the other way.
#include "edge/control/follow_monitor.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

FollowMonitor after(std::int32_t ordered_w, std::int32_t measured_w, int cycles) {
  FollowMonitor monitor;
  for (int i = 0; i < cycles; ++i) monitor.observe(ordered_w, measured_w);
  return monitor;
}

TEST(FollowMonitor, TripsAtTheThirdOrderThatIsOpposed) {
  EXPECT_FALSE(after(4'000, -4'000, 2).has_tripped());
  EXPECT_TRUE(after(4'000, -4'000, 3).has_tripped());
  EXPECT_TRUE(after(-4'000, 3'000, 3).has_tripped());
}

TEST(FollowMonitor, OneGoodAnswerStartsTheCountAgain) {
  FollowMonitor monitor = after(4'000, -4'000, 2);
  monitor.observe(4'000, 3'900);
  monitor.observe(4'000, -4'000);
  monitor.observe(4'000, -4'000);
  EXPECT_FALSE(monitor.has_tripped());
}

TEST(FollowMonitor, StaysTripped) {
  FollowMonitor monitor = after(4'000, -4'000, 3);
  monitor.observe(4'000, 4'000);
  EXPECT_TRUE(monitor.has_tripped());
}

TEST(FollowMonitor, NoiseIsNoAnswer) {
  const FollowMonitor monitor = after(4'000, -399, 10);  // under a tenth of the order
  EXPECT_FALSE(monitor.has_tripped());
  EXPECT_EQ(monitor.unanswered_orders(), 10);
}

TEST(FollowMonitor, IdleOrdersAreNeitherOpposedNorIgnored) {
  const FollowMonitor monitor = after(0, -3'000, 10);  // the house draws on the battery
  EXPECT_FALSE(monitor.has_tripped());
  EXPECT_EQ(monitor.unanswered_orders(), 0);
}

TEST(FollowMonitor, AnAnswerEndsTheIdleCount) {
  FollowMonitor monitor = after(4'000, 0, 5);
  monitor.observe(4'000, 4'000);
  EXPECT_EQ(monitor.unanswered_orders(), 0);
}

}  // namespace
}  // namespace bess
