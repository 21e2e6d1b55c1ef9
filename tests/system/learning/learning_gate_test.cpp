// Learning gate: the teacher that `bess-train train` makes by default, trained on the benchmark,
// earns more than the rule-based controller and no less than tabular value iteration and the
// stochastic program that it started as, on held-out days. The seed is fixed and training is
// bit-identical, so the verdict on a build is reproducible.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "shared/local_time.h"
#include "tests/support/market_series.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/policy/planners/stochastic_program.h"
#include "workstation/policy/rl/train.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {
namespace {

TrainResult train_by_default(const MarketSteps& market, const RunConfig& config) {
  const auto interrupted = [] { return false; };
  TrainResult result = train_teacher(market, config.battery, config.train, interrupted);
  fmt::print("trained for {:.0f} s, kept at step {} of {}\n", result.seconds, result.best_step,
             config.train.steps);
  return result;
}

PairedDifference lead(const char* over, const Evaluation& teacher, const Evaluation& other) {
  const PairedDifference lead = paired_difference(teacher, other);
  fmt::print("  over {:8} {:.1f}: {:+.1f}, s.e. {:.1f}\n", over, other.profit_eur_per_day_per_mwh(),
             lead.mean, lead.errors.plain);
  return lead;
}

TEST(LearningGate, TheTeacherIsAboveTheRuleAndLevelWithTabularAndTheProgram) {
  set_market_time_zone();
  const RunConfig config = load_run_config("");
  const MarketSteps market = make_market_steps(read_benchmark(), config.market);
  const TrainResult training = train_by_default(market, config);
  TeacherPolicy teacher(training.teacher);
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  TabularPolicy tabular(market, market.days_of(Split::kTrain), config.battery);
  StochasticProgramPolicy program(market, market.days_of(Split::kTrain), config.battery);
  ASSERT_EQ(training.curve.front().step, 0);
  EXPECT_EQ(
      training.curve.front().validation_eur_per_day_per_mwh,
      evaluate(market, market.days_of(Split::kValidation), program, {config.battery, 0.5, true})
          .profit_eur_per_day_per_mwh())
      << "step 0 is the program";
  EXPECT_LT(training.curve.back().edge_mass_frac, 5e-3) << "the default warns of its own support";
  // 42 days give a better estimate than the 20 test days. Of the validation days the teacher only
  // knows which of its seven weight sets was best.
  const std::vector<MarketDay> days = market.days_of(Split::kHeldOut);
  for (const bool carry_soc : {false, true}) {
    const EvaluationOptions options{config.battery, config.initial_soc_frac, carry_soc};
    const Evaluation earned = evaluate(market, days, teacher, options);
    fmt::print("{}, {} days: {:.1f} EUR/day/MWh\n", carry_soc ? "carried over" : "day reset",
               days.size(), earned.profit_eur_per_day_per_mwh());
    const PairedDifference over_rule = lead("rule", earned, evaluate(market, days, rule, options));
    EXPECT_GT(over_rule.mean, 2 * over_rule.errors.plain);
    // Level: another processor's vectors make another teacher, and a tie must pass.
    const PairedDifference over_tabular =
        lead("tabular", earned, evaluate(market, days, tabular, options));
    EXPECT_GE(over_tabular.mean, -over_tabular.errors.plain);
    const PairedDifference over_program =
        lead("program", earned, evaluate(market, days, program, options));
    EXPECT_GE(over_program.mean, -over_program.errors.plain);
  }
}

}  // namespace
}  // namespace bess
