// Benchmarks of import, environment and baselines on a year of the simulated market.
#include "tests/bench/registry.h"
#include "tests/bench/simulated_year.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/plan_cache.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/policy/planners/foresight.h"
#include "workstation/policy/planners/outlook_program.h"

namespace bess {
namespace {

double evaluate_year(Policy& policy) {
  const MarketSteps& market = year_of_steps();
  return evaluate(market, market.days, policy, {}).profit_eur_per_day_per_mwh();
}

/// The year with day-ahead prices derived from its own settled prices.
MarketSteps year_with_outlook() {
  const MinuteSeries& minutes = year_of_minutes();
  std::vector<QuarterHour> quarter_hours;
  for (std::size_t m = 0; m + 15 <= minutes.size(); m += 15) {
    quarter_hours.push_back({.utc_s = minutes.utc_s(m), .price_eur_per_mwh = minutes.settled[m]});
  }
  MarketSteps market = year_of_steps();
  attach_day_ahead(market,
                   std::make_shared<DayAheadPublication>(simulate_day_ahead(quarter_hours, 1)));
  return market;
}

}  // namespace

void register_market_benchmarks() {
  add_benchmark("import-year", benchmark::kSecond, 5, [](benchmark::State& state) {
    const std::string text = format_minute_csv(year_of_minutes(), "");
    for (auto _ : state) {
      const MinuteSeries series = parse_minute_csv(text, "year");
      benchmark::DoNotOptimize(make_market_steps(series, {}).steps.data());
    }
  });
  add_benchmark("env-steps", benchmark::kMillisecond, 5, [](benchmark::State& state) {
    RuleBasedPolicy policy(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
    for (auto _ : state) benchmark::DoNotOptimize(evaluate_year(policy));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(year_of_steps().steps.size()));
  });
  add_benchmark("rule-year", benchmark::kSecond, 5, [](benchmark::State& state) {
    RuleBasedPolicy policy(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
    for (auto _ : state) benchmark::DoNotOptimize(evaluate_year(policy));
  });
  add_benchmark("foresight-year", benchmark::kSecond, 3, [](benchmark::State& state) {
    ForesightPolicy policy{BatteryParameters{}};
    for (auto _ : state) benchmark::DoNotOptimize(evaluate_year(policy));
  });
  // Midnight's plan and its first decision: a day's plan for the two adjacent levels.
  add_benchmark("outlook-day-plan", benchmark::kMillisecond, 5, [](benchmark::State& state) {
    const MarketSteps market = year_with_outlook();
    const std::vector<MarketDay> training(market.days.begin(), market.days.begin() + 60);
    const OutlookProgram program(market, training, BatteryParameters{});
    std::size_t day = 60;
    for (auto _ : state) {
      const MarketStep& step = market.of(market.days[day]).front();
      OutlookProgram::Plan plan = program.plan_of(step);
      benchmark::DoNotOptimize(program.action_values(step, 0.5, plan));
      day = day + 1 < market.days.size() ? day + 1 : 60;
    }
  });
  // Plan of a student by outlook, in the integers of the edge.
  add_benchmark("outlook-integer-plan", benchmark::kMillisecond, 5, [](benchmark::State& state) {
    const MarketSteps market = year_with_outlook();
    const std::vector<MarketDay> training(market.days.begin(), market.days.begin() + 60);
    const OutlookModel model =
        outlook_integers(OutlookProgram(market, training, BatteryParameters{}));
    const auto plan = std::make_unique<OutlookPlan>();
    std::size_t day = 60;
    for (auto _ : state) {
      const MarketStep& step = market.of(market.days[day]).front();
      plan->make(model, outlook_days_of(step), planned_level_centi(step.level_centi_eur_per_mwh));
      benchmark::DoNotOptimize(plan.get());
      day = day + 1 < market.days.size() ? day + 1 : 60;
    }
  });
  add_benchmark("tabular-fit", benchmark::kSecond, 3, [](benchmark::State& state) {
    const std::vector<MarketDay> training = year_of_steps().days_of(Split::kTrain);
    for (auto _ : state) {
      TabularPolicy policy(year_of_steps(), training, BatteryParameters{});
      benchmark::DoNotOptimize(&policy);
    }
  });
}

}  // namespace bess
