// Benchmark figures, computed independently of this program [SPEC 8]: real settled quarter-hours of
// January to May 2023 with reconstructed minutes, test days.
#include <gtest/gtest.h>

#include "tests/support/market_series.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

const MinuteSeries& benchmark() {
  static const MinuteSeries series = read_benchmark();
  return series;
}

struct Setting {
  int delay_min;
  Settlement settlement;
  bool carry_soc;
  double rule, tabular, foresight;  ///< EUR per day per MWh
};

TEST(BenchmarkFigures, RuleTabularAndForesightOnTestDays) {
  const Setting settings[] = {{1, Settlement::kMinute, false, 412.4, 575.0, 987.4},
                              {0, Settlement::kStep, false, 443.0, 620.6, 992.9},
                              {2, Settlement::kMinute, false, 400.8, 561.6, 987.4},
                              {1, Settlement::kMinute, true, 356.2, 557.5, 940.7}};
  for (const Setting& s : settings) {
    const MarketSteps market = make_market_steps(
        benchmark(), {.observation_delay_min = s.delay_min, .settlement = s.settlement});
    const std::vector<MarketDay> days = market.days_of(Split::kTest);
    EvaluationOptions options;
    options.carry_soc = s.carry_soc;
    RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
    TabularPolicy tabular(market, market.days_of(Split::kTrain), options.battery);
    ForesightPolicy foresight(options.battery);
    const Evaluation by_rule = evaluate(market, days, rule, options);
    const Evaluation by_tabular = evaluate(market, days, tabular, options);
    const Evaluation by_foresight = evaluate(market, days, foresight, options);
    const auto label = testing::Message() << "delay " << s.delay_min << " carry " << s.carry_soc;
    EXPECT_NEAR(by_rule.profit_eur_per_day_per_mwh(), s.rule, 1.0) << label;
    EXPECT_NEAR(by_tabular.profit_eur_per_day_per_mwh(), s.tabular, 6.0) << label;
    EXPECT_NEAR(by_foresight.profit_eur_per_day_per_mwh(), s.foresight, 1.0) << label;
    if (s.carry_soc) continue;  // one plan for the whole series: no bound for single days
    for (std::size_t d = 0; d < days.size(); ++d) {
      EXPECT_GE(by_foresight.days[d].profit_eur, by_rule.days[d].profit_eur - 0.01) << label;
      EXPECT_GE(by_foresight.days[d].profit_eur, by_tabular.days[d].profit_eur - 0.01) << label;
    }
  }
}

}  // namespace
}  // namespace bess
