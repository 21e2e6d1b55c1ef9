// Frozen price under new stamps: what counts as frozen, and what does not.
#include "edge/core/control/frozen_price.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kFirstMinute = 1'679'875'200;

/// One row every two minutes, as a controller sees them.
class Rows {
 public:
  explicit Rows(const FrozenPriceSettings& settings = {}) : frozen(settings) {}
  void add(int rows, std::int32_t centi) {
    for (int i = 0; i < rows; ++i) frozen.observe(minute_utc_s += kSecondsPerStep, centi);
  }

  FrozenPrice frozen;
  std::int64_t minute_utc_s = kFirstMinute;
};

TEST(FrozenPrice, IsReportedAfterHalfAnHourAndNoPriceAfterThree) {
  Rows rows;
  rows.add(15, 5'550);
  EXPECT_EQ(rows.frozen.price().unchanged_s, 28 * 60);
  EXPECT_FALSE(rows.frozen.is_frozen());
  rows.add(1, 5'550);
  EXPECT_TRUE(rows.frozen.is_frozen()) << "30 minutes from stamp to stamp";
  rows.add(74, 5'550);
  EXPECT_FALSE(rows.frozen.is_no_price());
  rows.add(1, 5'550);
  EXPECT_TRUE(rows.frozen.is_no_price());
  rows.add(1, 5'551);  // a cent is enough
  EXPECT_EQ(rows.frozen.price().unchanged_s, 0);
  EXPECT_FALSE(rows.frozen.is_frozen() || rows.frozen.is_no_price());
}

TEST(FrozenPrice, OneSecondIsALimitAndZeroIsNone) {
  Rows soon({.stop_s = 1}), never({.frozen_s = 0, .stop_s = 0});
  soon.add(2, 5'550);
  never.add(2'000, 5'550);
  EXPECT_TRUE(soon.frozen.is_no_price());
  EXPECT_FALSE(never.frozen.is_frozen() || never.frozen.is_no_price());
}

TEST(FrozenPrice, ZeroAndTheEndsOfTheRangeArePricesLikeOthers) {
  for (const std::int32_t centi : {0, -1, 9'999'900, -9'999'900, 10'000'000, -10'000'000}) {
    Rows rows;
    rows.add(16, centi);
    EXPECT_TRUE(rows.frozen.is_frozen()) << centi;
  }
}

TEST(FrozenPrice, TheSameRowAgainIsNoNewStamp) {
  Rows rows;
  rows.add(1, 700);
  for (int i = 0; i < 100; ++i) rows.frozen.observe(rows.minute_utc_s, 700);
  EXPECT_EQ(rows.frozen.price().unchanged_s, 0);
}

/// A frozen source that also drops rows: no outage resets it, and none counts towards its hours.
TEST(FrozenPrice, AnOutageCountsAsOneStepAndAFewMinutes) {
  Rows rows;
  rows.add(2, 700);
  rows.minute_utc_s += 9 * 3'600;
  rows.add(1, 700);
  EXPECT_EQ(rows.frozen.price().unchanged_s, 6 * 60);
  for (int i = 0; i < 7; ++i) {
    rows.minute_utc_s += 3'600;
    rows.add(1, 700);
  }
  EXPECT_TRUE(rows.frozen.is_frozen());
}

TEST(FrozenPrice, ARestartDoesNotResetIt) {
  Rows rows;
  for (int run = 0; run < 6; ++run) {
    FrozenPrice next{FrozenPriceSettings{}};
    next.restore(rows.frozen.price());
    rows.frozen = next;
    rows.add(3, 700);
  }
  EXPECT_TRUE(rows.frozen.is_frozen());
  EXPECT_EQ(rows.frozen.price().unchanged_s, 17 * kSecondsPerStep);
  FrozenPrice moved{FrozenPriceSettings{}};
  moved.restore(rows.frozen.price());
  moved.observe(rows.minute_utc_s + 120, 701);
  EXPECT_EQ(moved.price().unchanged_s, 0);
}

/// A wrong clock left a stamp of the future.
TEST(FrozenPrice, AStampOfTheFutureNeitherCountsNorOverflows) {
  FrozenPrice frozen{FrozenPriceSettings{}};
  frozen.restore(
      {.minute_utc_s = INT64_MAX / 2, .centi_eur_per_mwh = 700, .unchanged_s = INT32_MAX});
  frozen.observe(kFirstMinute, 700);
  EXPECT_EQ(frozen.price().unchanged_s, INT32_MAX);
  frozen.observe(kFirstMinute + 120, 700);
  EXPECT_EQ(frozen.price().unchanged_s, INT32_MAX);
  for (const UnchangedPrice& damaged :
       {UnchangedPrice{INT64_MIN, 700, INT32_MIN}, UnchangedPrice{kFirstMinute, 700, INT32_MIN},
        UnchangedPrice{INT64_MAX, 700, -1}}) {
    frozen.restore(damaged);
    frozen.observe(kFirstMinute + 120, 700);
    EXPECT_EQ(frozen.price().unchanged_s, 0);
  }
}

/// Rows that rotate among `values`, each for `each` rows.
Rows rows_among(int values, int each, int rows) {
  Rows r;
  for (int i = 0; i < rows; ++i) r.add(1, 5'000 + i / each % values);
  return r;
}

TEST(FrozenPrice, FourAlternatingValuesAreReportedAfterTwoHoursAndNoPriceAfterSevenAndAHalf) {
  for (const int values : {2, 3, 4}) {
    for (const int each : {1, 2, 7}) {
      EXPECT_FALSE(rows_among(values, each, 60).frozen.is_frozen()) << values << ' ' << each;
      EXPECT_TRUE(rows_among(values, each, 61).frozen.is_frozen()) << values << ' ' << each;
      EXPECT_FALSE(rows_among(values, each, 225).frozen.is_no_price()) << values << ' ' << each;
      EXPECT_TRUE(rows_among(values, each, 226).frozen.is_no_price()) << values << ' ' << each;
    }
  }
  EXPECT_FALSE(rows_among(5, 1, 2'000).frozen.is_frozen());
  EXPECT_FALSE(rows_among(5, 7, 2'000).frozen.is_frozen());
}

TEST(FrozenPrice, AFifthValueResetsItAndTheOthersCountFromWhenTheyWereAlone) {
  Rows rows = rows_among(4, 1, 226);  // ends with the second of the four
  rows.add(1, 9'999);
  EXPECT_FALSE(rows.frozen.is_frozen() || rows.frozen.is_no_price());
  for (int i = 0; i < 55; ++i) rows.add(1, 5'000 + i % 2);
  EXPECT_FALSE(rows.frozen.is_frozen());
  rows.add(1, 5'000);
  EXPECT_TRUE(rows.frozen.is_frozen());
}

TEST(FrozenPrice, APriceThatMovesAfterHoursIsNotAlternating) {
  for (const int rows_frozen : {16, 91, 1'000}) {
    Rows rows;
    for (int i = 0; i < 40; ++i) rows.add(1, 5'000 + i % 3);
    rows.add(rows_frozen, 5'000);
    EXPECT_TRUE(rows.frozen.is_frozen());
    rows.add(1, 5'001);
    EXPECT_FALSE(rows.frozen.is_frozen() || rows.frozen.is_no_price()) << rows_frozen;
    for (int i = 0; i < 59; ++i) rows.add(1, 5'000 + i % 2);
    EXPECT_FALSE(rows.frozen.is_frozen());
    rows.add(1, 5'001);
    EXPECT_TRUE(rows.frozen.is_frozen());
  }
}

TEST(FrozenPrice, ToAndFroIsRecalledByTheLogAndAnOutageIsAFewMinutes) {
  FrozenPrice next{FrozenPriceSettings{}};
  std::int64_t minute_utc_s = kFirstMinute;
  for (int i = 0; i < 60; ++i) next.recall(minute_utc_s += 120, 700 + i % 2);
  EXPECT_EQ(next.price().unchanged_s, 0);
  next.restore({.minute_utc_s = minute_utc_s, .centi_eur_per_mwh = 701, .unchanged_s = 0});
  EXPECT_FALSE(next.is_frozen());
  next.observe(minute_utc_s += 120, 700);
  EXPECT_TRUE(next.is_frozen());

  FrozenPrice gaps{FrozenPriceSettings{}};
  for (int i = 0; i < 30; ++i) gaps.recall(minute_utc_s += 9 * 3'600, 700 + i % 2);
  EXPECT_FALSE(gaps.is_frozen()) << "29 times four minutes";
  for (int i = 0; i < 2; ++i) gaps.recall(minute_utc_s += 9 * 3'600, 700 + i % 2);
  EXPECT_TRUE(gaps.is_frozen());
  gaps.observe(INT64_MIN, 700);
  gaps.observe(INT64_MAX, 701);
  gaps.observe(kFirstMinute, 700);
}

}  // namespace
}  // namespace bess
