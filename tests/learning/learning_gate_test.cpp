// The gate on learning: the C51 teacher, trained on the yardstick for a quarter of the steps that `bess-train
// train` takes by default, earns more than the rule-based controller and no less than tabular value iteration, on
// days that it was not trained on. The seed is fixed and training repeats to the bit, so the verdict
// on a build is the same every time.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "shared/local_time.h"
#include "tests/support/market_series.h"
#include "workstation/cli/run_config.h"
#include "workstation/planners/tabular.h"
#include "workstation/rl/train.h"

namespace bess {
namespace {

TrainResult train_by_default(const MarketSteps& market, const RunConfig& config) {
  const std::atomic<bool> interrupted = false;
  TrainResult result = train_teacher(market, config.battery, config.train, interrupted);
  fmt::print("trained for {:.0f} s, best at step {} of {}\n", result.seconds, result.best_step,
             config.train.steps);
  return result;
}

PairedDifference lead(const char* over, const Evaluation& teacher, const Evaluation& other) {
  const PairedDifference lead = paired_difference(teacher, other);
  fmt::print("  over {:8} {:.1f}: {:+.1f}, s.e. {:.1f}\n", over, other.profit_eur_per_day_per_mwh(),
             lead.mean, lead.standard_error);
  return lead;
}

TEST(LearningGate, TheTeacherIsAboveTheRuleAndLevelWithTabular) {
  set_market_time_zone();
  RunConfig config = load_run_config("");
  config.train.method = Method::kC51;
  config.train.steps /= 4;
  const MarketSteps market = make_market_steps(read_yardstick(), config.market);
  const TrainResult training = train_by_default(market, config);
  TeacherPolicy teacher(training.teacher);
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  TabularPolicy tabular(market, market.days_of(Split::kTrain), config.battery);
  // 42 days judge better than the 20 test days alone. Of the validation days the teacher knows which of its
  // 16 sets of weights they liked.
  const std::vector<MarketDay> days = market.days_of(Split::kHeldOut);
  for (const bool carry_soc : {false, true}) {
    const EvaluationOptions options{config.battery, config.initial_soc_frac, carry_soc};
    const Evaluation earned = evaluate(market, days, teacher, options);
    fmt::print("{}, {} days: {:.1f} EUR/day/MWh\n", carry_soc ? "carried over" : "day reset",
               days.size(), earned.profit_eur_per_day_per_mwh());
    const PairedDifference over_rule = lead("rule", earned, evaluate(market, days, rule, options));
    EXPECT_GT(over_rule.mean, 2 * over_rule.standard_error);
    // Level: another processor's vectors make another teacher, and a tie by chance must pass.
    const PairedDifference over_tabular =
        lead("tabular", earned, evaluate(market, days, tabular, options));
    EXPECT_GE(over_tabular.mean, -over_tabular.standard_error);
  }
}

}  // namespace
}  // namespace bess
