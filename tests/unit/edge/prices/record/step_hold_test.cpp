// Rows far from the previous one: a wrong one has no effect, a correct one is a row late.
#include "edge/prices/record/newest_row.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

/// Rows in order, after one of minute 10.
class StepHold : public testing::Test {
 protected:
  /// Whether the row is taken.
  bool takes(std::int64_t minute, std::int32_t price_centi) {
    const std::int64_t now_ns = minute * 60'000'000'000;
    rows.publish(Status::kOk, {.minute_utc_s = 60 * minute, .price_centi_eur_per_mwh = price_centi},
                 now_ns, 0);
    return rows.report().minute_utc_s == 60 * minute &&
           rows.report().price_centi_eur_per_mwh == price_centi;
  }
  void restart(std::int32_t price_centi = 10'000) {
    rows = {};
    EXPECT_TRUE(takes(10, price_centi));
  }
  void SetUp() override { restart(); }

  NewestRow rows;
  const PriceReport& report = rows.report();
};

TEST_F(StepHold, ASmallStepIsAcceptedUpToTheLimitAndClearsThePendingRow) {
  for (const bool has_lied : {false, true}) {
    for (const std::int32_t price : {10'001, 12'000, -220'000, 240'000}) {
      restart();
      EXPECT_FALSE(has_lied && takes(11, -900'000));
      EXPECT_TRUE(takes(12, price)) << price;
      EXPECT_FALSE(report.large_step) << price;
      EXPECT_FALSE(report.step_held);
    }
  }
}

TEST_F(StepHold, ALargeStepIsHeldUntilALaterRowConfirmsIt) {
  EXPECT_FALSE(takes(11, 900'000));
  EXPECT_TRUE(report.step_held);
  EXPECT_EQ(report.held_centi_eur_per_mwh, 900'000);
  EXPECT_FALSE(takes(11, 900'000)) << "one row twice, not two rows";
  EXPECT_FALSE(takes(11, 900'100)) << "a correction is no proof";
  EXPECT_TRUE(takes(12, 800'000));
  EXPECT_TRUE(report.large_step);
  EXPECT_FALSE(report.step_held);
}

TEST_F(StepHold, ContradictoryRowsAreNeverAccepted) {
  for (int minute = 11; minute < 60; ++minute) {
    EXPECT_FALSE(takes(minute, minute % 2 == 0 ? 900'000 : -900'000));
  }
  EXPECT_TRUE(report.step_held);
}

TEST_F(StepHold, ARowOlderThanTheHeldOneChangesNothing) {
  EXPECT_FALSE(takes(14, 900'000));
  EXPECT_FALSE(takes(12, 10'000));
  EXPECT_EQ(report.held_centi_eur_per_mwh, 900'000);
  EXPECT_FALSE(takes(14, 900'000)) << "it is still of minute 14";
}

TEST_F(StepHold, FromOneEndOfAllPricesToTheOtherNothingOverflows) {
  restart(-10'000'000);
  EXPECT_FALSE(takes(11, 10'000'000));
  EXPECT_TRUE(takes(12, 10'000'000)) << "confirmed";
}

}  // namespace
}  // namespace bess
