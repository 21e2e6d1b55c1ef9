// Final charge as money. With the SoC carried over, a policy starts with the initial SoC and ends
// with any. The difference is sold or bought back at the mean settled price of the counted days,
// with losses, costs and wear, so that ending empty gives no advantage.
//
// Foresight also runs the days between the counted ones and may enter counted days charged. For it
// the changes over all counted days are summed, which for every other policy equals the last SoC
// minus the initial one.
//
// Not used with the day reset: there the final charge of each day is not valued, which favours the
// policy.
#pragma once

#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

/// Mean over the steps of `days`, which must not be empty.
double mean_settled_eur_per_mwh(const MarketSteps& market, const std::vector<MarketDay>& days);

/// Adds the value of the final charge (negative if below the initial SoC) to the last day of
/// `carried_over`: profit, throughput and charge_value_eur. May be called once; no effect without
/// days.
void value_charge_left(Evaluation& carried_over, const BatteryParameters& battery,
                       double price_eur_per_mwh);

/// Evaluates `days`, which must not be empty, with the SoC carried over; values the final charge.
Evaluation evaluate_carried_over(const MarketSteps& market, const std::vector<MarketDay>& days,
                                 Policy& policy, const BatteryParameters& battery,
                                 double initial_soc_frac,
                                 std::vector<StepRecord>* records = nullptr);

}  // namespace bess
