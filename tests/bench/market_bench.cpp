// Import, environment and baselines on a year of the simulated market.
#include "tests/bench/registry.h"
#include "tests/bench/simulated_year.h"
#include "workstation/env/evaluate.h"
#include "workstation/planners/foresight.h"
#include "workstation/planners/tabular.h"

namespace bess {
namespace {

double evaluate_year(Policy& policy) {
  const MarketSteps& market = year_of_steps();
  return evaluate(market, market.days, policy, {}).profit_eur_per_day_per_mwh();
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
  add_benchmark("tabular-fit", benchmark::kSecond, 3, [](benchmark::State& state) {
    const std::vector<MarketDay> training = year_of_steps().days_of(Split::kTrain);
    for (auto _ : state) {
      TabularPolicy policy(year_of_steps(), training, BatteryParameters{});
      benchmark::DoNotOptimize(&policy);
    }
  });
}

}  // namespace bess
