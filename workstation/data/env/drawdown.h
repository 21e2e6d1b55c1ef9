// How deep a policy's days fall: one definition, for every page and table. The drawdown is the
// deepest fall of what all days before together brought, from the end of a day to that of a later
// one, the beginning being 0; never within a day.
#pragma once

#include <span>
#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

/// EUR per MWh of capacity, by day.
std::vector<double> daily_profits(const Evaluation& evaluation);

/// Running sum.
std::vector<double> cumulative(std::span<const double> days);
/// Each sum minus the highest until then, 0 at the beginning included: not positive.
std::vector<double> below_peak(std::span<const double> cumulative);
/// The deepest of these, not negative.
double drawdown(std::span<const double> days);

}  // namespace bess
