#include "workstation/runs/log/log_input.h"

#include "shared/host/user_error.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

NamedEvaluation run(const std::string& name, const ReadLog& read, double soc_frac, Policy& policy,
                    ContextKind context) {
  const MarketSteps market = market_of_log(read.log, read.prices, read.span, context);
  return {name,
          {},
          evaluate(market, market.days, policy, {read.battery, soc_frac, true}),
          policy.description()};
}

NamedEvaluation run_named(const std::string& name, const ReadLog& read, double soc_frac) {
  const Baseline* baseline = find_baseline(name);
  if (baseline != nullptr && baseline->is_for(kFitted)) {
    fail("--policy {} needs fitting: use bess-train evaluate on the prices of these days", name);
  }
  if (const auto policy = make_baseline(name, {}, read.battery)) {
    return run(name, read, soc_frac, *policy, ContextKind::kLevel);
  }
  const StudentFile student = student_for_log(name);
  return run(name, read, soc_frac, *exported_policy(student), student.net.context.kind);
}

}  // namespace

std::vector<NamedEvaluation> compare_log(const ReadLog& read,
                                         const std::vector<std::string>& policies) {
  const MarketSteps market = market_of_log(read.log, read.prices, read.span, ContextKind::kLevel);
  if (market.steps.empty())
    fail("the log has no control cycle with a price on these days; change --from or --to");
  std::vector<NamedEvaluation> all{{kThisBattery, {}, evaluation_of(read.days, read.battery)}};
  const double soc_frac = all.front().carried_over.days.front().soc_start_frac;
  for (const std::string& name : policies) all.push_back(run_named(name, read, soc_frac));
  all.push_back(run_named(kForesightName, read, soc_frac));
  const double mean_eur_per_mwh = mean_settled_eur_per_mwh(market, market.days);
  for (NamedEvaluation& one : all) {
    value_charge_left(one.carried_over, read.battery, mean_eur_per_mwh);
  }
  return all;
}

NetEarnings net_earnings_of(const Evaluation& evaluation) {
  NetEarnings paid{};
  for (const DayResult& day : evaluation.days) {
    paid.paid_eur += day.profit_eur - day.charge_value_eur;
    paid.charge_eur += day.charge_value_eur;
  }
  return paid;
}

}  // namespace bess
