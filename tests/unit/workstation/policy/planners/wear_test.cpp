// The daily cycle limit holds against every policy.
#include <gtest/gtest.h>

#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

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
  for (const char* name : {"rbc:60:140", "foresight"}) {
    const auto policy = make_baseline(name, market, battery);
    const Evaluation e = evaluate(market, limited_days(market), *policy, {battery, 0.5, true});
    for (const DayResult& day : e.days) {
      EXPECT_LT(day.cycles, 1.5 + step_cycles) << name << ' ' << day.date;
    }
    EXPECT_GT(e.cycles_per_day(), 1.2) << name;  // a new day starts afresh
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
