// Wear counts wherever money does, and the daily cycle limit holds against every policy.
#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/small_market.h"
#include "workstation/planners/baselines.h"
#include "workstation/rl/experience.h"

namespace bess {
namespace {

Evaluation evaluate_name(const char* name, const MarketSteps& market, double planned_wear,
                         double charged_wear) {
  BatteryParameters battery;
  battery.wear_eur_per_mwh = planned_wear;
  const auto policy = make_baseline(name, market, battery);
  battery.wear_eur_per_mwh = charged_wear;
  return evaluate(market, market.days_of(Split::kTest), *policy, {battery, 0.5, false});
}

TEST(Wear, IsSubtractedFromProfitByThroughput) {
  const MarketSteps market = make_market_steps(small_series(), {});
  const Evaluation free = evaluate_name("rbc:60:140", market, 0, 0);
  const Evaluation worn = evaluate_name("rbc:60:140", market, 0, 12);
  for (std::size_t d = 0; d < free.days.size(); ++d) {
    const double throughput_mwh = free.days[d].cycles * 2 * 8;
    EXPECT_NEAR(worn.days[d].profit_eur, free.days[d].profit_eur - 12 * throughput_mwh, 1e-6);
  }
}

TEST(Wear, PlannersThatKnowItMoveLessAndEarnMore) {
  const MarketSteps market = make_market_steps(small_series(), {});
  for (const char* name : {"rbc-tuned", "tabular", "mpc", "foresight"}) {
    const Evaluation unaware = evaluate_name(name, market, 0, 25);
    const Evaluation aware = evaluate_name(name, market, 25, 25);
    EXPECT_LT(aware.cycles_per_day(), unaware.cycles_per_day()) << name;
    EXPECT_GT(aware.profit_eur_per_day_per_mwh(), unaware.profit_eur_per_day_per_mwh()) << name;
  }
}

TEST(Wear, LowersTheLearnersRewardInBothDirections) {
  const MarketSteps market = make_market_steps(small_series(), {});
  const PriceMap map = PriceMap::fit(observed_training_prices(market));
  BatteryParameters battery;
  const TrainingMarket free(market, map, battery, Horizon::kContinuing, {});
  battery.wear_eur_per_mwh = 10;
  const TrainingMarket worn(market, map, battery, Horizon::kContinuing, {});
  for (const Action action : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
    Transition a;
    Transition b;
    free.make_transition(100, 0.5, action, a);
    worn.make_transition(100, 0.5, action, b);
    // 4 MW at 10 EUR/MWh, in units of 1e4 EUR/h.
    EXPECT_NEAR(a.reward - b.reward, action == Action::kIdle ? 0 : 40e-4, 1e-6);
  }
}

/// Plans under a limit of cycles are dear to make: two days of them.
std::vector<MarketDay> limited_days(const MarketSteps& market) {
  auto days = market.days_of(Split::kTest);
  days.resize(2);
  return days;
}

TEST(CycleLimit, NoOrderAfterItIsReachedUntilMidnight) {
  const MarketSteps market = make_market_steps(small_series(28), {});
  BatteryParameters battery;
  battery.cycles_per_day_max = 1.5;
  const double step_cycles = 4.0 / 30 / 16;
  for (const char* name : {"rbc:60:140", "tabular", "foresight"}) {
    const auto policy = make_baseline(name, market, battery);
    for (const bool carry_soc : {false, true}) {
      const Evaluation e =
          evaluate(market, limited_days(market), *policy, {battery, 0.5, carry_soc});
      for (const DayResult& day : e.days) {
        EXPECT_LT(day.cycles, 1.5 + step_cycles) << name << ' ' << day.date;
      }
      EXPECT_GT(e.cycles_per_day(), 1.2) << name;  // a new day starts afresh
    }
  }
}

TEST(CycleLimitPlans, SaveTheCyclesForTheBestHours) {
  const MarketSteps market = make_market_steps(small_series(28), {});
  BatteryParameters battery;
  battery.cycles_per_day_max = 0.5;
  const auto days = limited_days(market);
  const auto profit = [&](Policy& policy) {
    return evaluate(market, days, policy, {battery, 0.5, false}).profit_eur_per_day_per_mwh();
  };
  const double foresight = profit(*make_baseline("foresight", market, battery));
  for (const char* name : {"rbc:60:140", "rbc-tuned", "tabular"}) {
    EXPECT_LT(profit(*make_baseline(name, market, battery)), foresight) << name;
  }
  const double rolling = profit(*make_baseline("mpc", market, battery));
  EXPECT_LT(rolling, foresight);
  // Fitted without knowing of the limit they run into it before the evening.
  BatteryParameters unlimited = battery;
  unlimited.cycles_per_day_max = 0;
  EXPECT_GT(rolling, profit(*make_baseline("mpc", market, unlimited)));
  EXPECT_GT(foresight, profit(*make_baseline("foresight", market, unlimited)));
}

TEST(TunedRule, DoesNothingWhereNoSpreadPaysForTheWear) {
  const MarketSteps market = make_market_steps(small_series(28), {});
  BatteryParameters battery;
  battery.wear_eur_per_mwh = 1000;
  const auto tuned = make_baseline("rbc-tuned", market, battery);
  const Evaluation e =
      evaluate(market, market.days_of(Split::kTrain), *tuned, {battery, 0.5, true});
  EXPECT_EQ(e.profit_eur_per_day_per_mwh(), 0);
}

}  // namespace
}  // namespace bess
