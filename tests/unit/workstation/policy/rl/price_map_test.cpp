#include "workstation/policy/rl/network_input.h"

#include "shared/nn/student_net.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

std::vector<double> normal_prices(double mean, double deviation, std::size_t count) {
  Random random(61);
  std::vector<double> prices(count);
  for (double& price : prices) price = mean + deviation * random.normal();
  return prices;
}

TEST(PriceMap, OfAnyPricesIncreasesAndIsClampedOutside) {
  const struct {
    const char* name;
    std::vector<double> prices;
    bool inside;  ///< all prices are within the lattice, so the map reaches 0 and 1
  } cases[] = {{"one price", {55.5}, true},
               {"one price many times", {7, 7, 7}, true},
               {"two prices", {-20, 300}, true},
               {"like a market", normal_prices(100, 80, 20'000), true},
               {"narrow", normal_prices(100, 0.001, 5'000), true},
               {"on both ends", {-500, 0, 1500}, true},
               {"wider than the lattice", normal_prices(300, 3'000, 5'000), false},
               {"all above", {2000, 3000}, false},
               {"all below", {-900, -700}, false}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const PriceMap map = PriceMap::fit(c.prices);
    const auto& table = map.table();
    for (std::size_t i = 1; i < table.size(); ++i) ASSERT_GT(table[i], table[i - 1]) << i;
    EXPECT_GE(table.front(), 0);
    EXPECT_LE(table.back(), 1 << 14);
    if (c.inside) {
      EXPECT_EQ(table.front(), 0);
      EXPECT_EQ(table.back(), 1 << 14);
    }
    float last = -1;
    for (double price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh;
         price += 0.25) {
      const float x = map(price);
      ASSERT_GT(x, last) << price;
      last = x;
      if (price == std::floor(price)) {
        const auto i = static_cast<std::size_t>(price - kLatticePriceMinEurPerMwh);
        ASSERT_EQ(x, static_cast<float>(table[i]) / static_cast<float>(1 << 14)) << price;
      }
    }
    for (const double below : {-500.01, -15'000.0, -1e300}) EXPECT_EQ(map(below), map(-500));
    for (const double above : {1500.01, 15'000.0, 1e300}) EXPECT_EQ(map(above), map(1500));
    EXPECT_GE(map(-1e300), 0);
    EXPECT_LE(map(1e300), 1);
    EXPECT_EQ(PriceMap(table).table(), table) << "rebuilt from its table";
  }
}

TEST(PriceMap, ResolutionIsWherePricesAre) {
  const PriceMap map = PriceMap::fit(normal_prices(100, 30, 20'000));
  EXPECT_GT(map(110) - map(90), 5 * (map(910) - map(890)));
  EXPECT_NEAR(map(100), 0.5 * 0.3 + 0.5 * 0.5, 0.01);  // half the line, half the median
}

/// Header text on the training prices of its student.
TEST(PriceMap, KeepsTheQuartilesOfItsPrices) {
  std::vector<double> prices = normal_prices(100, 80, 20'000);
  for (std::size_t i = 0; i < prices.size(); i += 9) prices[i] *= 12;  // far beyond the lattice
  StudentNet net{};
  std::ranges::copy(PriceMap::fit(prices).table(), net.price_map);
  std::ranges::sort(prices);
  for (const int quartile : {1, 2, 3}) {
    EXPECT_NEAR(learnt_price_quartile(net, quartile),
                prices[static_cast<std::size_t>(quartile) * 5'000], 1)
        << quartile;
  }
}

TEST(PriceMap, FitNeedsPrices) { EXPECT_THROW((void)PriceMap::fit({}), UserError); }

TEST(PriceMap, DamagedTableIsRefusedWithThePrice) {
  const auto sound = straight_price_map().table();
  const struct {
    std::size_t at;
    std::int16_t value;
    const char* price;
  } damages[] = {{0, -1, "-500"}, {1, 0, "-499"},        {500, sound[499], "0"},
                 {500, 0, "0"},   {1000, 32'767, "501"}, {2000, -32'768, "1500"}};
  for (const auto& damage : damages) {
    auto table = sound;
    table[damage.at] = damage.value;
    EXPECT_THAT(refusal_of([&] { (void)PriceMap(table); }),
                Names(std::string(damage.price) + " EUR/MWh"));
  }
}

TEST(PriceMap, TheInverseGivesThePriceBack) {
  const PriceMap map = PriceMap::fit({-20, 10, 40, 90, 95, 100, 180, 400});
  for (double price = -500; price <= 1500; price += 0.25) {
    EXPECT_NEAR(map.price_of(map(price)), price, 0.05) << price;
  }
  EXPECT_EQ(map.price_of(0), -500);
  EXPECT_EQ(map.price_of(1), 1500);
}

}  // namespace
}  // namespace bess
