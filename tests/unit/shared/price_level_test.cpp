// Trailing price level: which prices count, how often, how much, and the effect of a gap.
#include "shared/price_level.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kMinute = 1'679'788'740;  // 2023-03-25T23:59:00Z

constexpr PriceLevel level_after(std::int32_t first_centi, std::int32_t second_centi) {
  PriceLevel level;
  level.observe(kMinute, first_centi);
  level.observe(kMinute + 120, second_centi);
  return level;
}

TEST(PriceLevel, IsUnknownUntilTheFirstRowSetsIt) {
  PriceLevel level;
  EXPECT_FALSE(level.is_known());
  EXPECT_EQ(level.centi_eur_per_mwh(), 0);
  level.observe(kMinute, -12'345);
  EXPECT_TRUE(level.is_known());
  EXPECT_EQ(level.centi_eur_per_mwh(), -12'345);
  EXPECT_EQ(level.centi_q16, -12'345 * 65'536LL);
  EXPECT_EQ(level.row_minute_utc_s, kMinute);
}

TEST(PriceLevel, EachNewRowMovesItByOneIn720) {
  EXPECT_EQ(level_after(10'000, 10'000 + 720).centi_q16, 10'001 * 65'536LL);
  EXPECT_EQ(level_after(10'000, 10'000 - 720).centi_q16, 9'999 * 65'536LL);
  EXPECT_EQ(level_after(10'000, 10'000), (PriceLevel{10'000 * 65'536LL, kMinute + 120}));
}

TEST(PriceLevel, ARowCountsOnceAndAnOlderOneNever) {
  PriceLevel level = level_after(10'000, 20'000);
  const PriceLevel before = level;
  level.observe(kMinute + 120, 90'000);  // the same minute, even with another price
  level.observe(kMinute + 60, 90'000);
  level.observe(0, 90'000);
  EXPECT_EQ(level, before);
}

TEST(PriceLevel, RestsInAGapHoweverLong) {
  PriceLevel soon = level_after(10'000, 20'000);
  PriceLevel late = soon;
  soon.observe(kMinute + 240, 5'000);
  late.observe(kMinute + 365 * 86'400LL, 5'000);
  EXPECT_EQ(soon.centi_q16, late.centi_q16);
}

TEST(PriceLevel, CountsPricesAsTheStudentSeesThem) {
  EXPECT_EQ(level_after(10'000, 1'500'000), level_after(10'000, 150'000));
  EXPECT_EQ(level_after(10'000, -1'500'000), level_after(10'000, -50'000));
  EXPECT_NE(level_after(10'000, 150'000), level_after(10'000, 149'999));
  EXPECT_EQ(level_after(INT32_MAX, INT32_MAX).centi_eur_per_mwh(), 150'000);
  EXPECT_EQ(level_after(INT32_MIN, INT32_MIN).centi_eur_per_mwh(), -50'000);
}

/// Halves round up on both sides of zero, in the mean and in its output: identical on every
/// machine.
TEST(PriceLevel, RoundsNegativePricesAsPositiveOnes) {
  const struct {
    std::int64_t centi_q16;
    std::int32_t centi;
  } shown[] = {{32'767, 0}, {32'768, 1},   {-32'768, 0},  {-32'769, -1},
               {65'536, 1}, {-65'536, -1}, {-98'304, -1}, {-98'305, -2}};
  for (const auto& c : shown) {
    EXPECT_EQ((PriceLevel{c.centi_q16, kMinute}).centi_eur_per_mwh(), c.centi) << c.centi_q16;
  }
  // 65536 / 720 = 91.02 and -91.02 of 2^-16; 5 x 65536 / 720 = 455.1.
  EXPECT_EQ(level_after(0, 1).centi_q16, 91);
  EXPECT_EQ(level_after(0, -1).centi_q16, -91);
  EXPECT_EQ(level_after(0, 5).centi_q16, 455);
  EXPECT_EQ(level_after(0, -5).centi_q16, -455);
  PriceLevel half{.centi_q16 = 360, .row_minute_utc_s = kMinute};  // moves by -1/2: up, to 0
  half.observe(kMinute + 120, 0);
  EXPECT_EQ(half.centi_q16, 360);
  half = {.centi_q16 = -360, .row_minute_utc_s = kMinute};  // moves by +1/2: up, to 1
  half.observe(kMinute + 120, 0);
  EXPECT_EQ(half.centi_q16, -359);
}

TEST(PriceLevel, MayStartAtASetPriceAndAnyRowCountsThen) {
  PriceLevel level = PriceLevel::starting_at(-2'500);
  EXPECT_TRUE(level.is_known() && level.is_sound());
  EXPECT_EQ(level.centi_eur_per_mwh(), -2'500);
  level.observe(60, -2'500 + 720);
  EXPECT_EQ(level.centi_eur_per_mwh(), -2'499);
  EXPECT_EQ(PriceLevel::starting_at(INT32_MAX).centi_eur_per_mwh(), 150'000);
}

TEST(PriceLevel, IsSoundOnlyWithinTheLattice) {
  EXPECT_TRUE(PriceLevel{}.is_sound());
  EXPECT_TRUE((PriceLevel{150'000 * 65'536LL, kMinute}).is_sound());
  EXPECT_TRUE((PriceLevel{-50'000 * 65'536LL, kMinute}).is_sound());
  EXPECT_FALSE((PriceLevel{150'000 * 65'536LL + 1, kMinute}).is_sound());
  EXPECT_FALSE((PriceLevel{-50'000 * 65'536LL - 1, kMinute}).is_sound());
  EXPECT_FALSE((PriceLevel{INT64_MIN, kMinute}).is_sound());
  EXPECT_FALSE((PriceLevel{0, -60}).is_sound());
}

}  // namespace
}  // namespace bess
