// Profit as a function of two thresholds is a step function with many local peaks, so the search is
// derivative-free and in ranks of the observed prices, where the steps are even:
//   u in [0,1]^2:  low = quantile(u0),  high = quantile(u0 + (1 - u0) * u1)  >=  low
// DIRECT-L covers the square, Subplex climbs from its best point; both are deterministic.
// [Jones, Perttunen, Stuckman 1993; Gablonsky, Kelley 2001; Rowan 1990; NLopt]
#include "workstation/planners/tuned_rule.h"

#include <nlopt.hpp>

#include <algorithm>

#include "shared/host/user_error.h"
#include "workstation/env/evaluate.h"

namespace bess {
namespace {

constexpr int kGlobalEvaluations = 600;  // a few milliseconds each for a year
constexpr int kLocalEvaluations = 300;
constexpr double kLocalStep = 0.02;

class TrainingProfit {
 public:
  TrainingProfit(const MarketSteps& market, const std::vector<MarketDay>& days,
                 const BatteryParameters& battery)
      : market_(market), days_(days) {
    options_.battery = battery;
    options_.initial_soc_frac = 0.5 * (battery.soc_min_frac + battery.soc_max_frac);
    options_.carry_soc = true;
    for (const MarketDay& day : days) {
      for (const MarketStep& step : market.of(day)) prices_.push_back(step.observed_eur_per_mwh);
    }
    std::ranges::sort(prices_);
  }

  [[nodiscard]] RuleThresholds thresholds(const std::vector<double>& u) const {
    return {quantile(u[0]), quantile(u[0] + (1 - u[0]) * u[1])};
  }

  [[nodiscard]] double at(const std::vector<double>& u) const {
    const RuleThresholds t = thresholds(u);
    RuleBasedPolicy rule(t.low_eur_per_mwh, t.high_eur_per_mwh);
    return evaluate(market_, days_, rule, options_).profit_eur_per_day_per_mwh();
  }
  static double objective(const std::vector<double>& u, std::vector<double>&, void* self) {
    return static_cast<const TrainingProfit*>(self)->at(u);
  }

 private:
  [[nodiscard]] double quantile(double rank) const {
    const auto last = static_cast<double>(prices_.size() - 1);
    return prices_[static_cast<std::size_t>(std::clamp(rank, 0.0, 1.0) * last + 0.5)];
  }

  const MarketSteps& market_;
  const std::vector<MarketDay>& days_;
  EvaluationOptions options_;
  std::vector<double> prices_;  ///< observed on the training days, ascending
};

/// Moves `u` to the best point that `algorithm` finds.
void maximise(nlopt::algorithm algorithm, int evaluations, TrainingProfit& profit,
              std::vector<double>& u) {
  nlopt::opt search(algorithm, 2);
  search.set_max_objective(TrainingProfit::objective, &profit);
  search.set_lower_bounds(0.0);
  search.set_upper_bounds(1.0);
  search.set_maxeval(evaluations);
  if (algorithm != nlopt::GN_DIRECT_L) search.set_initial_step(kLocalStep);
  double best = 0;
  try {
    search.optimize(u, best);
  } catch (const nlopt::roundoff_limited&) {
    return;  // u holds the best point so far, and no finer step can tell points apart
  }
}

}  // namespace

RuleThresholds tune_rule(const MarketSteps& market, const std::vector<MarketDay>& days,
                         const BatteryParameters& battery) {
  require_training_days(days.size());
  TrainingProfit profit(market, days, battery);
  std::vector<double> u = {0.25, 0.67};  // the quartiles, roughly
  maximise(nlopt::GN_DIRECT_L, kGlobalEvaluations, profit, u);
  maximise(nlopt::LN_SBPLX, kLocalEvaluations, profit, u);
  // The corner "never trade" wins when wear costs more than any spread; the search only nears it.
  for (const std::vector<double>& corner : {std::vector{0.0, 1.0}, std::vector{0.25, 2.0 / 3}}) {
    if (profit.at(corner) > profit.at(u)) u = corner;
  }
  return profit.thresholds(u);
}

}  // namespace bess
