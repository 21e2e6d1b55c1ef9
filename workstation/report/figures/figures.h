// The report's figures, each a pure function from results to a Figure.
#pragma once

#include <span>
#include <vector>

#include "shared/price_thresholds.h"
#include "workstation/correction/distil.h"
#include "workstation/env/evaluate.h"
#include "workstation/report/figures/figure.h"
#include "workstation/report/figures/policy_map.h"
#include "workstation/rl/train.h"

namespace bess {

/// What the paper's rule earns on the validation days as a teacher is judged there, charge carried
/// over.
double rule_validation_profit(const MarketSteps& market, const BatteryParameters& battery);

/// Validation profit and loss over gradient steps, and the rule; `curve` not empty. A curve that
/// has a step 0 is a residual's, which was the stochastic program then.
Figure learning_figure(const std::vector<CurvePoint>& curve,
                       double rule_validation_eur_per_day_per_mwh);

/// The three losses over epochs; `curve` not empty.
Figure distillation_figure(const std::vector<DistilPoint>& curve);

/// One to three policies side by side over price and SoC, the boxes of the rules that hold then
/// outlined; `note` opens the caption.
Figure policy_map_figure(const PolicyContext& context, const ContextClasses& classes,
                         const std::vector<NamedPolicyMap>& maps, const RuleSet& rules,
                         const BatteryParameters& battery, const std::string& note);

/// Distribution of observed prices on training and on test days, with the prices at which the
/// student and the paper's rule must act.
Figure price_density_figure(const MarketSteps& market, const PriceThresholds& student);

/// What one policy did on one day.
struct DayStory {
  std::string date;
  std::string policy;
  std::span<const MarketStep> steps;
  std::span<const StepRecord> records;  ///< same steps
  BatteryParameters battery;
};
Figure day_figure(const DayStory& story);

/// The test day with the largest difference between its highest and lowest paid price; null when
/// there is no test day.
const MarketDay* widest_test_day(const MarketSteps& market);

}  // namespace bess
