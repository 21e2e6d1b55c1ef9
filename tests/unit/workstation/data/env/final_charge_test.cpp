// Value of the final charge, by hand; ending empty gains nothing.
#include "workstation/data/env/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/market_series.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

/// 8 MWh; each entry is a day's SoC at its start and at its end, without profit.
Evaluation carried_over(const std::vector<std::pair<double, double>>& days) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 8;
  for (const auto& [start, end] : days) {
    DayResult day{"2023-01-26", 0, 0, 0, end};
    day.soc_start_frac = start;
    evaluation.days.push_back(day);
  }
  return evaluation;
}

TEST(ChargeLeft, SurplusIsSoldAndWhatIsMissingBoughtBack) {
  const BatteryParameters battery;
  Evaluation surplus = carried_over({{0.5, 0.2}, {0.2, 0.75}});
  EXPECT_FALSE(surplus.values_charge_left());
  value_charge_left(surplus, battery, 100);
  EXPECT_TRUE(surplus.values_charge_left());
  EXPECT_EQ(surplus.days[0].profit_eur, 0);
  EXPECT_NEAR(surplus.days[1].profit_eur, 2 * std::sqrt(0.9) * 100, 1e-9);  // 2 of 8 MWh stored
  EXPECT_EQ(surplus.days[1].charge_value_eur, surplus.days[1].profit_eur);
  EXPECT_NEAR(surplus.charge_left().value_eur_per_day_per_mwh, std::sqrt(0.9) * 200 / 2 / 8, 1e-12);
  Evaluation missing = carried_over({{0.5, 0.25}});
  value_charge_left(missing, battery, 100);
  EXPECT_NEAR(missing.days[0].profit_eur, -2 / std::sqrt(0.9) * 100, 1e-9);
  EXPECT_THROW(value_charge_left(missing, battery, 100), std::logic_error) << "twice";
}

/// The valuing exchange has wear and costs like any other, also at another wear.
TEST(ChargeLeft, ItsExchangeCostsWhatOthersCost) {
  BatteryParameters battery;
  battery.wear_eur_per_mwh = 10;
  battery.costs.export_fee_eur_per_mwh = 5;
  Evaluation surplus = carried_over({{0.5, 0.75}});
  surplus.wear_eur_per_mwh = 10;
  value_charge_left(surplus, battery, 100);
  EXPECT_NEAR(surplus.days[0].profit_eur, 2 * std::sqrt(0.9) * (100 - 5 - 10), 1e-9);
  EXPECT_NEAR(surplus.profit_at_wear_eur_per_day_per_mwh(30),
              2 * std::sqrt(0.9) * (100 - 5 - 30) / 8, 1e-9);
}

/// Non-consecutive days, as the bound trades them: it starts the second one charged.
TEST(ChargeLeft, ChargeThatWasBoughtOnOtherDaysIsNoGift) {
  Evaluation bound = carried_over({{0.5, 0.1}, {1.0, 0.1}});
  value_charge_left(bound, {}, 100);
  EXPECT_NEAR(bound.days[1].charge_value_eur, -1.3 * 8 / std::sqrt(0.9) * 100, 1e-9);
}

/// Sells all of its charge.
class SellingPolicy final : public Policy {
 public:
  [[nodiscard]] Action decide(const MarketStep&, std::size_t, double) const override {
    return Action::kDischarge;
  }
};

/// At a constant price: selling the initial charge and buying it back costs the losses.
TEST(ChargeLeft, EndingEmptyEarnsNothingAtAFlatPrice) {
  MinuteSeries series = flat_series("2023-01-31T23:00:00Z", 2 * kMinutesPerDay, 80);
  series.indicative.assign(series.size(), 80);
  const MarketSteps market = make_market_steps(series, {});
  EXPECT_NEAR(mean_settled_eur_per_mwh(market, market.days), 80, 1e-9);
  SellingPolicy policy;
  Evaluation sold = evaluate(market, market.days, policy, {{}, 0.5, true});
  EXPECT_GT(sold.profit_eur_per_day_per_mwh(), 0) << "a gift";
  EXPECT_EQ(sold.days[1].soc_start_frac, sold.days[0].soc_end_frac);
  value_charge_left(sold, {}, mean_settled_eur_per_mwh(market, market.days));
  const double stored_mwh = 0.4 * 8;
  EXPECT_NEAR(sold.profit_eur_per_day_per_mwh(),
              stored_mwh * 80 * (std::sqrt(0.9) - 1 / std::sqrt(0.9)) / 2 / 8, 1e-6);
}

}  // namespace
}  // namespace bess
