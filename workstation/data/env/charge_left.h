// The charge that the battery ends with, as money. With the SoC carried over from day to day a
// policy starts with the initial SoC and ends with whatever it has: what is in the battery then,
// beyond what it began with, is taken as sold at once, and what is missing as bought back, at the
// mean settled price of the days that count, with losses, costs and wear. So nobody earns by ending
// empty.
//
// The bound knows days between those that count; it may enter them charged. Of it the changes over
// all days that count are summed, which for every other policy is the last SoC less the initial
// one.
//
// Not for days that start anew at the same SoC: their ends are given away, which is why that way of
// counting is the friendlier one.
#pragma once

#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

/// Mean over the steps of `days`, which are not empty.
double mean_settled_eur_per_mwh(const MarketSteps& market, const std::vector<MarketDay>& days);

/// Credits the last day of `carried_over` with the charge that is left, negative where it is
/// missing: in its profit, its throughput and its charge_value_eur. Once only; without days nothing
/// is done.
void value_charge_left(Evaluation& carried_over, const BatteryParameters& battery,
                       double price_eur_per_mwh);

}  // namespace bess
