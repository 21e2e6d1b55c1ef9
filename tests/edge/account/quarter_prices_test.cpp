// What a quarter-hour is paid at, by hand: settled, else the newest of its own minutes.
#include "edge/account/quarter_prices.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kQuarter = 1'679'785'200;

CycleRecord seen(std::int64_t utc_s, std::int64_t minute_utc_s, std::int32_t price_eur) {
  CycleRecord record{.utc_s = utc_s};
  record.price = {
      .has_row = true, .minute_utc_s = minute_utc_s, .price_centi_eur_per_mwh = price_eur * 100};
  return record;
}

TEST(QuarterPrices, AreTheSettledOneElseTheNewestOfTheirMinutes) {
  SettledPrices settled;
  QuarterPrices prices(settled);
  // The last minute of a quarter-hour is seen in the next.
  prices.note(seen(kQuarter + 960, kQuarter + 840, 90));
  prices.note(seen(kQuarter + 840, kQuarter + 780, 70));
  ASSERT_TRUE(prices.find(kQuarter + 899));
  EXPECT_EQ(prices.find(kQuarter)->eur_per_mwh, 90);
  EXPECT_EQ(prices.find(kQuarter)->state, PriceState::kIndicative);
  EXPECT_EQ(prices.find(kQuarter)->start_utc_s, kQuarter);
  // Of the next no minute of its own is known, of the one before and the one after nothing.
  EXPECT_EQ(prices.find(kQuarter + 900)->eur_per_mwh, 90);
  EXPECT_FALSE(prices.find(kQuarter - 1));
  EXPECT_FALSE(prices.find(kQuarter + 1'800));
  prices.note(seen(kQuarter + 1'080, kQuarter + 1'020, -20));
  EXPECT_EQ(prices.find(kQuarter + 900)->eur_per_mwh, -20);
  CycleRecord blind = seen(kQuarter + 1'200, kQuarter + 1'140, 500);
  blind.price.has_row = false;
  prices.note(blind);
  EXPECT_EQ(prices.find(kQuarter + 900)->eur_per_mwh, -20);
  settled.put(std::vector<SettledQuarter>{{kQuarter, 85, PriceState::kValidated}});
  EXPECT_EQ(prices.find(kQuarter)->eur_per_mwh, 85);
  EXPECT_EQ(prices.find(kQuarter)->state, PriceState::kValidated);
}

/// Two minutes from 60 s before its end, and from 57 s before.
TEST(QuarterPrices, PayAStepByWhereItLies) {
  SettledPrices settled;
  settled.put(std::vector<SettledQuarter>{{kQuarter, 100}, {kQuarter + 900, 220}});
  const QuarterPrices prices(settled);
  EXPECT_DOUBLE_EQ(prices.of_step_eur_per_mwh(kQuarter + 780).value_or(0), 100);
  EXPECT_DOUBLE_EQ(prices.of_step_eur_per_mwh(kQuarter + 840).value_or(0), 160);
  EXPECT_DOUBLE_EQ(prices.of_step_eur_per_mwh(kQuarter + 843).value_or(0), 163);
  EXPECT_DOUBLE_EQ(prices.of_step_eur_per_mwh(kQuarter + 1'740).value_or(0), 220);
  EXPECT_FALSE(prices.of_step_eur_per_mwh(kQuarter - 60));
}

}  // namespace
}  // namespace bess
