// Rows far from the previous one: a wrong one has no effect, a correct one is a row late.
#include "edge/prices/record/newest_row.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr PriceRow kBefore{.minute_utc_s = 600, .price_centi_eur_per_mwh = 10'000};

constexpr PriceRow row_at(std::int64_t minute, std::int32_t price_centi) {
  return {.minute_utc_s = 60 * minute, .price_centi_eur_per_mwh = price_centi};
}

TEST(StepHold, ASmallStepIsAcceptedUpToTheLimitAndClearsThePendingRow) {
  for (const bool has_lied : {false, true}) {
    for (const std::int32_t price : {10'001, 12'000, -220'000, 240'000}) {
      StepHold hold;
      EXPECT_FALSE(has_lied && hold.judge(kBefore, row_at(11, -900'000)).is_taken);
      const auto verdict = hold.judge(kBefore, row_at(12, price));
      EXPECT_TRUE(verdict.is_taken) << price;
      EXPECT_FALSE(verdict.is_large_step) << price;
      EXPECT_FALSE(hold.has_held());
    }
  }
}

TEST(StepHold, ALargeStepIsHeldUntilALaterRowConfirmsIt) {
  StepHold hold;
  EXPECT_FALSE(hold.judge(kBefore, row_at(11, 900'000)).is_taken);
  EXPECT_TRUE(hold.has_held());
  EXPECT_EQ(hold.held().price_centi_eur_per_mwh, 900'000);
  EXPECT_FALSE(hold.judge(kBefore, row_at(11, 900'000)).is_taken) << "one row twice, not two rows";
  EXPECT_FALSE(hold.judge(kBefore, row_at(11, 900'100)).is_taken) << "a correction is no proof";
  const auto verdict = hold.judge(kBefore, row_at(12, 800'000));
  EXPECT_TRUE(verdict.is_taken);
  EXPECT_TRUE(verdict.is_large_step);
  EXPECT_FALSE(hold.has_held());
}

TEST(StepHold, ContradictoryRowsAreNeverAccepted) {
  StepHold hold;
  for (int minute = 11; minute < 60; ++minute) {
    const std::int32_t price = minute % 2 == 0 ? 900'000 : -900'000;
    EXPECT_FALSE(hold.judge(kBefore, row_at(minute, price)).is_taken);
  }
  EXPECT_TRUE(hold.has_held());
}

TEST(StepHold, ARowOlderThanTheHeldOneChangesNothing) {
  StepHold hold;
  EXPECT_FALSE(hold.judge(kBefore, row_at(14, 900'000)).is_taken);
  EXPECT_FALSE(hold.judge(kBefore, row_at(12, 10'000)).is_taken);
  EXPECT_EQ(hold.held().minute_utc_s, 14 * 60);
}

TEST(StepHold, FromOneEndOfAllPricesToTheOtherNothingOverflows) {
  constexpr PriceRow kLowest{.minute_utc_s = 600, .price_centi_eur_per_mwh = -10'000'000};
  StepHold hold;
  EXPECT_FALSE(hold.judge(kLowest, row_at(11, 10'000'000)).is_taken);
  EXPECT_TRUE(hold.judge(kLowest, row_at(12, 10'000'000)).is_taken) << "confirmed";
}

}  // namespace
}  // namespace bess
