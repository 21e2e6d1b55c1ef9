// Price history of a first start: the level of a controller that had run all the time.
#include "edge/core/control/price_history.h"

#include <gtest/gtest.h>

#include <vector>

namespace bess {
namespace {

constexpr std::int64_t kBetweenTicks = 1'679'788'890;  // 2023-03-26T00:01:30Z, between two ticks
constexpr std::int64_t kLastTick = 1'679'788'800;      // the last one, 00:00

/// The level after these rows at successive decisions.
PriceLevel level_of(const std::vector<std::pair<std::int64_t, std::int32_t>>& rows) {
  PriceLevel level;
  for (const auto& [minute_utc_s, centi] : rows) level.observe(minute_utc_s, centi);
  return level;
}

TEST(PriceHistory, TakesTheRowsThatDecisionsSaw) {
  PriceHistory history(1, kBetweenTicks);
  for (int minute = 10; minute >= 1; --minute) history.add(kLastTick - 60 * minute, 1'000 * minute);
  // The ticks were at -8, -6, ... 0 and each saw the row of the minute before it.
  EXPECT_EQ(history.level(), level_of({{kLastTick - 540, 9'000},
                                       {kLastTick - 420, 7'000},
                                       {kLastTick - 300, 5'000},
                                       {kLastTick - 180, 3'000},
                                       {kLastTick - 60, 1'000}}));
  EXPECT_EQ(history.rows(), 10);
  EXPECT_EQ(history.hours_covered(), 1);
}

TEST(PriceHistory, WhereARowIsMissingThePreviousOneWasSeen) {
  PriceHistory history(1, kBetweenTicks);
  history.add(kLastTick - 300, 5'000);
  history.add(kLastTick - 240, 4'000);  // seen at -2: the row of -3 is missing
  history.add(kLastTick - 60, 1'000);
  EXPECT_EQ(
      history.level(),
      level_of({{kLastTick - 300, 5'000}, {kLastTick - 240, 4'000}, {kLastTick - 60, 1'000}}));
}

TEST(PriceHistory, LeavesToTheLoopWhatNoTickHasSeenYet) {
  PriceHistory history(1, kBetweenTicks);
  history.add(kLastTick, 9'000);
  history.add(kLastTick + 60, 9'000);
  EXPECT_EQ(history.rows(), 0);
  history.add(kLastTick - 3'660, 9'000);  // and the rows before these hours
  history.add(INT64_MIN / 2, 9'000);
  EXPECT_EQ(history.rows(), 0);
  history.add(kLastTick - 3'600, 9'000);
  EXPECT_EQ(history.level(), level_of({{kLastTick - 3'600, 9'000}}));
}

TEST(PriceHistory, ARowThatComesTwiceCountsOnce) {
  PriceHistory history(1, kBetweenTicks);
  history.add(kLastTick - 60, 1'000);
  history.add(kLastTick - 60, 2'000);
  EXPECT_EQ(history.rows(), 1);
  EXPECT_EQ(history.level(), level_of({{kLastTick - 60, 2'000}}));
}

TEST(PriceHistory, HoldsTheLongestHours) {
  PriceHistory history(PriceHistory::kHoursMax, kBetweenTicks);
  for (int minute = 1; minute <= 100 * 60; ++minute) history.add(kLastTick - 60 * minute, 12'300);
  EXPECT_EQ(history.rows(), 96 * 60);
  EXPECT_EQ(history.hours_covered(), 96);
  EXPECT_EQ(history.level().centi_eur_per_mwh(), 12'300);
}

}  // namespace
}  // namespace bess
