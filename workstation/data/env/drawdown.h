// Drawdown of a policy's daily results: the largest fall of the cumulative profit from the end of
// one day to that of a later one, starting at 0; not within a day.
#pragma once

#include <span>
#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

/// EUR per MWh of capacity, by day.
std::vector<double> daily_profits(const Evaluation& evaluation);

/// Running sum.
std::vector<double> cumulative(std::span<const double> days);
/// Each sum minus the highest so far, the initial 0 included: not positive.
std::vector<double> below_peak(std::span<const double> cumulative);
/// Largest fall, not negative.
double drawdown(std::span<const double> days);

}  // namespace bess
