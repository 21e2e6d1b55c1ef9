#include "workstation/planners/baselines.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "shared/host/user_error.h"
#include "workstation/planners/cycle_limit.h"
#include "workstation/planners/foresight.h"
#include "workstation/planners/outlook_program.h"
#include "workstation/planners/rolling_horizon.h"
#include "workstation/planners/stochastic_program.h"
#include "workstation/planners/tabular.h"
#include "workstation/planners/tuned_rule.h"

namespace bess {
namespace {

using Made = std::shared_ptr<Policy>;

Made rule(double low_eur_per_mwh, double high_eur_per_mwh) {
  return std::make_shared<RuleBasedPolicy>(low_eur_per_mwh, high_eur_per_mwh);
}

Made paper_rule(const MarketSteps&, const BatteryParameters&) {
  return rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
}

/// Quartiles of the training days' settled prices: the paper's rule without its look-ahead.
Made quartile_rule(const MarketSteps& market, const BatteryParameters&) {
  std::vector<double> prices;
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) prices.push_back(step.paid_eur_per_mwh);
  }
  require_training_days(prices.size());
  std::ranges::sort(prices);
  return rule(prices[prices.size() / 4], prices[prices.size() * 3 / 4]);
}

Made tuned_rule(const MarketSteps& market, const BatteryParameters& battery) {
  const RuleThresholds t = tune_rule(market, market.days_of(Split::kTrain), battery);
  return rule(t.low_eur_per_mwh, t.high_eur_per_mwh);
}

/// Fits a planner on the training days, mindful of a limit on daily cycles.
template <typename Planner, typename... Options>
Made fit(const MarketSteps& market, const BatteryParameters& battery, const Options&... options) {
  const std::vector<MarketDay> days = market.days_of(Split::kTrain);
  return std::make_shared<Planner>(
      market, days, battery_with_shadow_price<Planner>(market, days, battery, options...),
      options...);
}

Made program_by_hour(const MarketSteps& market, const BatteryParameters& battery) {
  return fit<StochasticProgramPolicy>(market, battery, StochasticProgramOptions{.level_weight = 0});
}

Made foresight(const MarketSteps&, const BatteryParameters& battery) {
  return std::make_shared<ForesightPolicy>(battery);
}

}  // namespace

std::span<const Baseline> baselines() {
  constexpr unsigned kCompared = kFitted | kInRuns | kUnlessToldOther;
  static const Baseline kRows[] = {
      {"rbc", "thresholds 11/179", "", "", kInRuns, paper_rule},
      {"rbc-quartile", "training days' quartiles", "", "", kFitted | kInRuns, quartile_rule},
      {"rbc-tuned", "thresholds that earn most on the training days", "the best pair of thresholds",
       "line-2", kCompared, tuned_rule},
      {"tabular", "", "", "", kCompared, fit<TabularPolicy>},
      {"mpc", "rolling horizon on a naive forecast", "rolling horizon", "line-3", kCompared,
       fit<RollingHorizonPolicy>},
      {kProgramName, "stochastic program by hour and price level", "stochastic program", "line-4",
       kCompared, fit<StochasticProgramPolicy>},
      {"sdp-hour", "by hour alone", "", "", kFitted, program_by_hour},
      {"sdp-outlook", "planned each day on --day-ahead", "", "", kFitted | kNeedsDayAhead,
       fit<OutlookPolicy>},
      {kForesightName, "", "knows every price: a bound, no rival", "muted", kInRuns, foresight},
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
  const char* at = name.data() + kGivenRule.size();
  const char* const end = name.data() + name.size();
  auto read = std::from_chars(at, end, low);
  const bool low_ok = read.ec == std::errc() && read.ptr != end && *read.ptr == ':';
  if (low_ok) read = std::from_chars(read.ptr + 1, end, high);
  if (!low_ok || read.ec != std::errc() || read.ptr != end || !std::isfinite(low) ||
      !std::isfinite(high) || low > high) {
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
