// Price of a quarter-hour, by hand: settled, otherwise the newest of its own minutes.
#include "shared/host/exchange.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kPricedQuarter = 1'679'785'200;

TEST(QuarterPrices, AreTheSettledOneElseTheNewestOfTheirMinutes) {
  const SettledQuarter settled[] = {{kPricedQuarter - 900, 85, PriceState::kValidated}};
  QuarterPrices prices(settled);
  // The last minute of a quarter-hour is seen in the next.
  prices.note(kPricedQuarter + 960, kPricedQuarter + 840, 90);
  prices.note(kPricedQuarter + 840, kPricedQuarter + 780, 70);
  ASSERT_TRUE(prices.find(kPricedQuarter + 899));
  EXPECT_EQ(prices.find(kPricedQuarter)->eur_per_mwh, 90);
  EXPECT_EQ(prices.find(kPricedQuarter)->state, PriceState::kIndicative);
  EXPECT_EQ(prices.find(kPricedQuarter)->start_utc_s, kPricedQuarter);
  // The next has no known minute of its own, the one after nothing at all.
  EXPECT_EQ(prices.find(kPricedQuarter + 900)->eur_per_mwh, 90);
  EXPECT_FALSE(prices.find(kPricedQuarter + 1'800));
  prices.note(kPricedQuarter + 1'080, kPricedQuarter + 1'020, -20);
  EXPECT_EQ(prices.find(kPricedQuarter + 900)->eur_per_mwh, -20);
  prices.note(kPricedQuarter - 60, kPricedQuarter - 120, 500);
  EXPECT_EQ(prices.find(kPricedQuarter - 1)->eur_per_mwh, 85);
  EXPECT_EQ(prices.find(kPricedQuarter - 1)->state, PriceState::kValidated);
  EXPECT_FALSE(prices.find(kPricedQuarter - 901));
}

}  // namespace
}  // namespace bess
