// The rule-based controller at its best: both thresholds chosen to earn most on the training days,
// days chained so that the first one's charge is not given away at each midnight [SPEC 4]. What a
// careful user would get without any learning, and so the fair peer of everything that learns.
#pragma once

#include "shared/battery_model.h"
#include "workstation/env/market_steps.h"

namespace bess {

struct RuleThresholds {
  double low_eur_per_mwh;   ///< charge below
  double high_eur_per_mwh;  ///< discharge above
};

/// Throws UserError when there are no training days in `days`.
RuleThresholds tune_rule(const MarketSteps& market, const std::vector<MarketDay>& days,
                         const BatteryParameters& battery);

}  // namespace bess
