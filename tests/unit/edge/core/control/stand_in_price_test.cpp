// Expected value of an old price.
#include "edge/core/control/level_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace bess {
namespace {

TEST(StandInPrice, NearsTheLevelWithATimeConstantOfAnHour) {
  EXPECT_EQ(stand_in_centi(40'000, 10'000, 0), 40'000);
  EXPECT_EQ(stand_in_centi(40'000, 10'000, 119), 40'000) << "by whole steps";
  EXPECT_EQ(stand_in_centi(40'000, 10'000, 120), 39'000);
  EXPECT_EQ(stand_in_centi(10'000, 10'000, 86'400), 10'000);
  std::mt19937_64 random(20'261'126);
  std::uniform_int_distribution<std::int32_t> centi(-9'999'900, 9'999'900);
  for (int i = 0; i < 2'000; ++i) {
    const std::int32_t newest = centi(random), level = centi(random) / 20;
    const std::int64_t age_s = static_cast<std::int64_t>(random() % 86'400);
    const std::int32_t stands_in = stand_in_centi(newest, level, age_s);
    const double distance = newest - double{1} * level;
    EXPECT_NEAR(stands_in, level + distance * std::exp(-static_cast<double>(age_s) / 3'600),
                15 + 0.04 * std::abs(distance));
    EXPECT_GE(stands_in, std::min(newest, level)) << "never beyond either";
    EXPECT_LE(stands_in, std::max(newest, level));
  }
}

}  // namespace
}  // namespace bess
