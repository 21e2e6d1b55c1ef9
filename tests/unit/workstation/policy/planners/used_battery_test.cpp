// Use of a battery in the environment: its capacity fades with throughput, a direction is kept for
// its minimum run, and the daily cycle limit holds for every policy.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

Evaluation trade(const BatteryParameters& battery, std::vector<StepRecord>* records = nullptr) {
  const auto policy = make_baseline("rbc:60:140", small_steps(), {});
  return evaluate(small_steps(), small_steps().days, *policy, {battery, 0.5, true}, records);
}

TEST(CapacityFade, IsOfThePartThatIsLeftAndOff) {
  BatteryParameters fading;
  EXPECT_EQ(trade(fading).profit_eur_per_day_per_mwh(), trade({}).profit_eur_per_day_per_mwh());
  fading.fade_percent_per_1000_cycles = 40;
  std::vector<StepRecord> records;
  const Evaluation faded = trade(fading, &records);
  double capacity_wh = fading.capacity_wh;
  for (std::size_t i = 0; i + 1 < records.size(); ++i) {
    const double moved_wh = records[i].power_w / 30;
    const double stored_wh =
        moved_wh > 0 ? moved_wh * fading.charge_efficiency : moved_wh / fading.discharge_efficiency;
    if (records[i + 1].utc_s == records[i].utc_s + 120) {
      ASSERT_NEAR((records[i + 1].soc_frac - records[i].soc_frac) * capacity_wh, stored_wh, 1);
    }
    capacity_wh -= capacity_wh * 0.4 / 1000 * std::fabs(moved_wh) / (2 * capacity_wh);
  }
  EXPECT_LT(capacity_wh, 0.98 * fading.capacity_wh);
  EXPECT_LT(faded.profit_eur_per_day_per_mwh(), trade({}).profit_eur_per_day_per_mwh());
  EXPECT_EQ(faded.capacity_mwh, 8) << "profits refer to the initial capacity";
}

TEST(MinimumRun, ADirectionIsKeptAndNothingElseIs) {
  BatteryParameters slow;
  slow.minimum_run_min = 20;
  std::vector<StepRecord> records;
  const Evaluation kept = trade(slow, &records);
  int run = 1, runs = 0, shortest = 1'000;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const bool goes_on = records[i].action == records[i - 1].action;
    if (!goes_on && records[i - 1].action != Action::kIdle) {
      shortest = std::min(shortest, run);
      ++runs;
    }
    run = goes_on ? run + 1 : 1;
  }
  EXPECT_EQ(shortest, 10);
  EXPECT_GT(runs, 50);
  EXPECT_LT(kept.switches_per_day(), trade({}).switches_per_day());
  slow.minimum_run_min = 2;
  EXPECT_EQ(trade(slow).profit_eur_per_day_per_mwh(), trade({}).profit_eur_per_day_per_mwh());
}

/// Plans under a limit of full cycles are expensive: two days of them.
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
    EXPECT_GT(e.cycles_per_day(), 1.2) << name;  // a new day starts at zero
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
  // Fitted without the limit they reach it before the evening.
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
