// How the process is asked to stop, and which signal hands the battery over to the next run.
#include "edge/app/program/edge_clock.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr ScaledClock kFast{.anchor_monotonic_ns = 1, .anchor_utc_s = 1'679'788'800, .scale = 900};

TEST(EdgeClock, SigtermStops) {
  EdgeClock clock(kFast);
  EXPECT_FALSE(clock.stop_requested());
  raise(SIGTERM);
  EXPECT_TRUE(clock.stop_requested());
  EXPECT_FALSE(clock.hand_over_requested());
}

TEST(EdgeClock, SighupHandsOver) {
  EdgeClock clock(kFast);
  raise(SIGHUP);
  EXPECT_TRUE(clock.stop_requested());
  EXPECT_TRUE(clock.hand_over_requested());
}

TEST(EdgeClock, SigtermWinsWhateverTheOrder) {
  {
    EdgeClock clock(kFast);
    raise(SIGHUP);
    EXPECT_TRUE(clock.stop_requested());
    raise(SIGTERM);
    EXPECT_FALSE(clock.hand_over_requested());
  }
  EdgeClock clock(kFast);
  raise(SIGTERM);
  EXPECT_TRUE(clock.stop_requested());
  raise(SIGHUP);
  EXPECT_FALSE(clock.hand_over_requested());
}

TEST(EdgeClock, SleepsToTheInstantAndNotPastAStop) {
  EdgeClock clock(kFast);
  const std::int64_t target_ns = clock.now_utc_ns() + 90 * kNanosecondsPerSecond;  // 0.1 s of wall
  EXPECT_TRUE(clock.sleep_until_utc_ns(target_ns));
  EXPECT_GE(clock.now_utc_ns(), target_ns);
  raise(SIGINT);
  EXPECT_FALSE(clock.sleep_until_utc_ns(clock.now_utc_ns() + 1'000'000 * kNanosecondsPerSecond));
}

}  // namespace
}  // namespace bess
