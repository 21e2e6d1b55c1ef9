#include "workstation/policy/planners/baselines.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/foresight.h"
#include "workstation/policy/planners/outlook_program.h"
#include "workstation/policy/planners/soc_grid.h"
#include "workstation/policy/planners/stochastic_program.h"

namespace bess {

namespace {

constexpr int kPhases = 15;
constexpr int kBins = 48;
constexpr int kSocPoints = 181;
constexpr double kPseudoCount = 0.001;
constexpr float kGamma = 0.999F;
/// 0.999^(15 * 400) = 0.0025: the value is within 0.3 % of its limit and the greedy action is
/// stable.
constexpr int kSweepsMax = 400;

using Values = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

TabularPolicy::TabularPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                             const BatteryParameters& battery)
    : battery_(battery) {
  require_training_days(days.size());
  count_market(market, days);
  iterate_values();
}

int TabularPolicy::price_bin(double price_eur_per_mwh) const {
  return static_cast<int>(std::ranges::upper_bound(bin_edges_, price_eur_per_mwh) -
                          bin_edges_.begin());
}

void TabularPolicy::count_market(const MarketSteps& market, const std::vector<MarketDay>& days) {
  std::vector<double> observed = market.prices_of(days, &MarketStep::observed_eur_per_mwh);
  std::ranges::sort(observed);
  for (int b = 1; b < kBins; ++b) {
    bin_edges_.push_back(observed[observed.size() * static_cast<std::size_t>(b) / kBins]);
  }
  std::vector<double> visits(kPhases * kBins, 0.0);
  std::vector<double> next(kPhases * kBins * kBins, kPseudoCount);
  import_.assign(kPhases * kBins, 0.0);
  export_.assign(kPhases * kBins, 0.0);
  for (const MarketDay& day : days) {
    const auto steps = market.of(day);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const int cell = steps[i].half_hour_phase * kBins + price_bin(steps[i].observed_eur_per_mwh);
      visits[cell] += 1;
      import_[cell] += battery_.costs.import_eur_per_mwh(steps[i].paid_eur_per_mwh);
      export_[cell] += battery_.costs.export_eur_per_mwh(steps[i].paid_eur_per_mwh);
      if (i + 1 < steps.size() && steps[i + 1].utc_s == steps[i].utc_s + kSecondsPerStep) {
        next[cell * kBins + price_bin(steps[i + 1].observed_eur_per_mwh)] += 1;
      }
    }
  }
  transition_.resize(next.size());
  for (int cell = 0; cell < kPhases * kBins; ++cell) {
    if (visits[cell] > 0) {
      import_[cell] /= visits[cell];
      export_[cell] /= visits[cell];
    }
    double total = 0;
    for (int b = 0; b < kBins; ++b) total += next[cell * kBins + b];
    for (int b = 0; b < kBins; ++b) {
      transition_[cell * kBins + b] = static_cast<float>(next[cell * kBins + b] / total);
    }
  }
}

void TabularPolicy::iterate_values() {
  const SocGrid grid(battery_, kSocPoints);
  const std::vector<GridMove> moves = tabulate_moves(battery_, grid);
  const auto wear = static_cast<float>(battery_.wear_eur_per_mwh);
  std::vector<Values> value(kPhases, Values::Zero(kBins, kSocPoints));
  greedy_.assign(kPhases * kBins * kSocPoints, Action::kIdle);
  for (int sweep = 0; sweep < kSweepsMax; ++sweep) {
    for (int phase = kPhases - 1; phase >= 0; --phase) {
      const Eigen::Map<const Values> chain(&transition_[phase * kBins * kBins], kBins, kBins);
      const Values expected = kGamma * (chain * value[(phase + 1) % kPhases]);
      for (int b = 0; b < kBins; ++b) {
        const auto import_price = static_cast<float>(import_[phase * kBins + b]);
        const auto export_price = static_cast<float>(export_[phase * kBins + b]);
        for (int i = 0; i < kSocPoints; ++i) {
          float worth[kActionCount];
          for (int a = 0; a < kActionCount; ++a) {
            const GridMove& move = moves[a * kSocPoints + i];
            const float price = move.energy_mwh > 0 ? import_price : export_price;
            worth[a] = interpolate(expected.row(b).data(), move.next) - price * move.energy_mwh -
                       wear * std::fabs(move.energy_mwh);
          }
          const Action best = argmax_action(worth);
          value[phase](b, i) = worth[static_cast<int>(best)];
          greedy_[(phase * kBins + b) * kSocPoints + i] = best;
        }
      }
    }
  }
}

Action TabularPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  const SocGrid grid(battery_, kSocPoints);
  const int cell = step.half_hour_phase * kBins + price_bin(step.observed_eur_per_mwh);
  return greedy_[cell * kSocPoints + grid.nearest(soc_frac)];
}

// Profit as a function of two thresholds is a step function with many local maxima. The search is
// derivative-free, in ranks of the observed prices, where the steps are even:
//   u in [0,1]^2:  low = quantile(u0),  high = quantile(u0 + (1 - u0) * u1)  >=  low
// DIRECT-L covers the square, Subplex refines its best point; both are deterministic.
// [Jones, Perttunen, Stuckman 1993; Gablonsky, Kelley 2001; Rowan 1990; NLopt]

namespace {

constexpr int kGlobalEvaluations = 600;  // a few milliseconds each for a year
constexpr int kLocalEvaluations = 300;
constexpr double kLocalStep = 0.02;

class TrainingProfit {
 public:
  TrainingProfit(const MarketSteps& market, const std::vector<MarketDay>& days,
                 const BatteryParameters& battery)
      : market_(market),
        days_(days),
        options_{battery, 0.5 * (battery.soc_min_frac + battery.soc_max_frac), true},
        prices_(market.prices_of(days, &MarketStep::observed_eur_per_mwh)) {
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

/// Sets `u` to the best point that `algorithm` finds.
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
    return;  // step below resolution: u is the best point so far
  }
}

}  // namespace

RuleThresholds tune_rule(const MarketSteps& market, const std::vector<MarketDay>& days,
                         const BatteryParameters& battery) {
  require_training_days(days.size());
  TrainingProfit profit(market, days, battery);
  std::vector<double> u = {0.25, 0.67};  // about the quartiles
  maximise(nlopt::GN_DIRECT_L, kGlobalEvaluations, profit, u);
  maximise(nlopt::LN_SBPLX, kLocalEvaluations, profit, u);
  // The corner "never trade" is best if wear exceeds any spread; the search only approaches it.
  for (const std::vector<double>& corner : {std::vector{0.0, 1.0}, std::vector{0.25, 2.0 / 3}}) {
    if (profit.at(corner) > profit.at(u)) u = corner;
  }
  return profit.thresholds(u);
}

namespace {

using PolicyPtr = std::shared_ptr<Policy>;

PolicyPtr rule(double low_eur_per_mwh, double high_eur_per_mwh) {
  return std::make_shared<RuleBasedPolicy>(low_eur_per_mwh, high_eur_per_mwh);
}

PolicyPtr paper_rule(const MarketSteps&, const BatteryParameters&) {
  return rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
}

/// Quartiles of the training days' settled prices: the paper's rule without its look-ahead.
PolicyPtr quartile_rule(const MarketSteps& market, const BatteryParameters&) {
  std::vector<double> prices =
      market.prices_of(market.days_of(Split::kTrain), &MarketStep::paid_eur_per_mwh);
  require_training_days(prices.size());
  std::ranges::sort(prices);
  return rule(prices[prices.size() / 4], prices[prices.size() * 3 / 4]);
}

PolicyPtr tuned_rule(const MarketSteps& market, const BatteryParameters& battery) {
  const RuleThresholds t = tune_rule(market, market.days_of(Split::kTrain), battery);
  return rule(t.low_eur_per_mwh, t.high_eur_per_mwh);
}

/// Fits a planner on the training days, within a limit on daily full cycles.
template <typename Planner, typename... Options>
PolicyPtr fit(const MarketSteps& market, const BatteryParameters& battery,
              const Options&... options) {
  const std::vector<MarketDay> days = market.days_of(Split::kTrain);
  return std::make_shared<Planner>(
      market, days, battery_with_shadow_price<Planner>(market, days, battery, options...),
      options...);
}

PolicyPtr program_by_hour(const MarketSteps& market, const BatteryParameters& battery) {
  return fit<StochasticProgramPolicy>(market, battery, 0.0);
}

PolicyPtr foresight(const MarketSteps&, const BatteryParameters& battery) {
  return std::make_shared<ForesightPolicy>(battery);
}

}  // namespace

std::span<const Baseline> baselines() {
  constexpr unsigned kCompared = kFitted | kInRuns | kUnlessToldOther;
  static const Baseline kRows[] = {
      {"rbc", "thresholds 11/179", "", "", kInRuns, paper_rule},
      {"rbc-quartile", "training days' quartiles", "", "", kFitted | kInRuns, quartile_rule},
      {"rbc-tuned", "best thresholds of the training days", "best pair of thresholds", "line-2",
       kCompared, tuned_rule},
      {"tabular", "", "", "", kCompared, fit<TabularPolicy>},
      {"mpc", "rolling horizon on a naive forecast", "rolling horizon", "line-3", kCompared,
       fit<RollingHorizonPolicy>},
      {kProgramName, "stochastic program by hour and price level", "stochastic program", "line-4",
       kCompared, fit<StochasticProgramPolicy>},
      {"sdp-hour", "program by hour only", "", "", kFitted, program_by_hour},
      {kOutlookProgramName, "program on --day-ahead prices, planned daily",
       "stochastic program by outlook", "line-5", kFitted | kNeedsDayAhead, fit<OutlookPolicy>},
      {kForesightName, "", "upper bound with all prices known", "muted", kInRuns, foresight},
  };
  return kRows;
}

std::vector<std::string> baseline_names(BaselineUse use) {
  std::vector<std::string> names;
  for (const Baseline& baseline : baselines()) {
    if (baseline.is_for(use)) names.push_back(baseline.name);
  }
  return names;
}

std::vector<std::string> rival_names() {
  std::vector<std::string> names;
  for (const Baseline& baseline : baselines()) {
    if (!baseline.meaning.empty()) names.push_back(baseline.name);
  }
  return names;
}

std::shared_ptr<Policy> given_rule(const std::string& name) {
  double low = 0;
  double high = 0;
  const std::string_view prices = std::string_view(name).substr(kGivenRule.size());
  const std::size_t colon = prices.find(':');
  if (colon == prices.npos || !read_number(prices.substr(0, colon), low) ||
      !read_number(prices.substr(colon + 1), high) || !std::isfinite(low) || !std::isfinite(high) ||
      low > high) {
    fail("--policy {}: use rbc:LOW:HIGH with two prices in EUR/MWh, LOW not above HIGH: rbc:11:179",
         name);
  }
  return rule(low, high);
}

const Baseline* find_baseline(std::string_view name) {
  const auto found = std::ranges::find(baselines(), name, &Baseline::name);
  return found == baselines().end() ? nullptr : &*found;
}

std::shared_ptr<Policy> make_baseline(const std::string& name, const MarketSteps& market,
                                      const BatteryParameters& battery) {
  if (name.starts_with(kGivenRule)) return given_rule(name);
  const Baseline* baseline = find_baseline(name);
  return baseline == nullptr ? nullptr : baseline->make(market, battery);
}

}  // namespace bess
