// File of settled prices: written, read back, damaged; newer prices replace older ones, and
// validated ones stay.
#include "edge/records/account/settled_prices.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr std::int64_t kSettledQuarter = 1'679'785'200;
constexpr PriceState kAsPublished = PriceState::kPublished, kAsValidated = PriceState::kValidated;

void put(SettledPrices& prices, const std::vector<SettledQuarter>& some) { prices.put(some); }

TEST(SettledPrices, AreWhatWasWritten) {
  SettledPrices prices;
  put(prices,
      {{kSettledQuarter + 900, -999.99, kAsPublished}, {kSettledQuarter, 131.07, kAsValidated}});
  SettledPrices read;
  ASSERT_TRUE(read.parse(prices.text()));
  EXPECT_EQ(read.quarters(), prices.quarters());
  ASSERT_NE(read.find(kSettledQuarter + 899), nullptr);
  EXPECT_EQ(read.find(kSettledQuarter + 899)->eur_per_mwh, 131.07);
  EXPECT_EQ(read.find(kSettledQuarter - 1), nullptr);
  EXPECT_EQ(read.find(kSettledQuarter + 1'800), nullptr);
  EXPECT_THAT(prices.text(), ::testing::HasSubstr("2023-03-25T23:00:00Z,131.07,validated\n"));
}

TEST(SettledPrices, WhatIsNewerCountsAndWhatIsValidatedStays) {
  SettledPrices prices;
  const auto put_both = [&](double first, PriceState state, double second, PriceState other) {
    put(prices, {{kSettledQuarter, first, state}, {kSettledQuarter + 900, second, other}});
  };
  put_both(10, kAsPublished, 20, kAsValidated);
  EXPECT_EQ(prices.first_open(kSettledQuarter), kSettledQuarter);
  EXPECT_EQ(prices.first_open(kSettledQuarter + 900), kSettledQuarter + 1'800);
  put_both(11, kAsPublished, 21, kAsPublished);
  EXPECT_EQ(prices.find(kSettledQuarter)->eur_per_mwh, 11);
  EXPECT_EQ(prices.find(kSettledQuarter + 900)->eur_per_mwh, 20);
  put_both(12, kAsValidated, 22, kAsValidated);
  EXPECT_EQ(prices.find(kSettledQuarter + 900)->eur_per_mwh, 22);
  EXPECT_EQ(prices.first_open(kSettledQuarter), kSettledQuarter + 1'800);
  prices.drop_before(kSettledQuarter + 1);
  EXPECT_EQ(prices.quarters().size(), 1u);
}

/// A damaged card: every byte of the file, in sequence.
TEST(SettledPrices, ADamagedFileIsRejected) {
  SettledPrices prices;
  put(prices, {{kSettledQuarter, 131.07, kAsValidated}, {kSettledQuarter + 900, 5, kAsPublished}});
  const std::string text = prices.text();
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string broken = text;
    broken[i] = static_cast<char>(broken[i] ^ 1);
    EXPECT_FALSE(prices.parse(broken)) << i;
    EXPECT_TRUE(prices.quarters().empty());
    EXPECT_FALSE(prices.parse(std::string_view(text).substr(0, i))) << i;
  }
  const TemporaryFolder folder;
  EXPECT_EQ(prices.read(folder.file("none.csv")), "");
  EXPECT_THAT(prices.read(folder.write("settled.csv", text + "x")), Names("settled.csv"));
  EXPECT_EQ(prices.read(folder.write("settled.csv", text)), "");
  EXPECT_EQ(prices.quarters().size(), 2u);
}

}  // namespace
}  // namespace bess
