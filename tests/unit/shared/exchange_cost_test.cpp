// Exchange costs by hand on one exchange, at a price above and below zero; without costs nothing
// changes.
#include "shared/battery_model.h"

#include <gtest/gtest.h>

#include "workstation/base/random.h"

namespace bess {
namespace {

struct ExchangeByHand {
  const char* name;
  double wear;
  TradingCosts costs;
  // Of 2 MWh, EUR: the cost of taking them, and the revenue of giving them.
  double taken_at_100, taken_at_minus_100;
  double given_at_100, given_at_minus_100;
};

const ExchangeByHand kCases[] = {
    {"nothing", 0, {}, 200, -200, 200, -200},
    {"import adder of 40", 0, {.import_adder_eur_per_mwh = 40}, 280, -120, 200, -200},
    {"5 % of the import price", 0, {.import_percent = 5}, 210, -190, 200, -200},
    {"export fee of 3", 0, {.export_fee_eur_per_mwh = 3}, 200, -200, 194, -206},
    {"5 % of the export price", 0, {.export_percent = 5}, 200, -200, 190, -210},
    {"wear of 10", 10, {}, 220, -180, 180, -220},
    {"all of them", 10, {40, 5, 3, 5}, 310, -90, 164, -236},
};

TEST(ExchangeCost, ByHand) {
  for (const ExchangeByHand& c : kCases) {
    SCOPED_TRACE(c.name);
    BatteryParameters battery;
    battery.wear_eur_per_mwh = c.wear;
    battery.costs = c.costs;
    EXPECT_DOUBLE_EQ(exchange_cost_eur(battery, 2, 100), c.taken_at_100);
    EXPECT_DOUBLE_EQ(exchange_cost_eur(battery, 2, -100), c.taken_at_minus_100);
    EXPECT_DOUBLE_EQ(-exchange_cost_eur(battery, -2, 100), c.given_at_100);
    EXPECT_DOUBLE_EQ(-exchange_cost_eur(battery, -2, -100), c.given_at_minus_100);
    EXPECT_EQ(exchange_cost_eur(battery, 0, 100), 0);
  }
}

TEST(ExchangeCost, WithoutAnyCostIsEnergyTimesPriceToTheBit) {
  Random random(11);
  for (int n = 0; n < 10'000; ++n) {
    const double mwh = random.uniform() - 0.5;
    const double price = 1000 * (random.uniform() - 0.5);
    ASSERT_EQ(exchange_cost_eur({}, mwh, price), mwh * price);
  }
}

}  // namespace
}  // namespace bess
