// Stop requests to the process, and the signal that hands the battery over to the next run.
#include "edge/app/program/edge_clock.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace bess {
namespace {

constexpr ScaledClock kFast{.anchor_monotonic_ns = 1, .anchor_utc_s = 1'679'788'800, .scale = 900};

TEST(EdgeClock, EitherSignalStopsAndSighupHandsOverUnlessSigtermCameToo) {
  const std::pair<std::vector<int>, bool> cases[] = {
      {{SIGTERM}, false}, {{SIGHUP}, true}, {{SIGHUP, SIGTERM}, false}, {{SIGTERM, SIGHUP}, false}};
  for (const auto& [signals, hands_over] : cases) {
    EdgeClock clock(kFast);
    EXPECT_FALSE(clock.stop_requested());
    for (const int signal : signals) {
      raise(signal);
      EXPECT_TRUE(clock.stop_requested());
    }
    EXPECT_EQ(clock.hand_over_requested(), hands_over);
  }
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
