// What a value distribution is for: the same teacher choosing by its mean and by the mean of its
// worst cases (rl/risk.h), and what that does to bad days.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// Shares of CVaR that a report shows beside the mean.
inline constexpr double kShownRiskShares[] = {0.1, 0.25};

/// "c51 teacher, cvar:0.1".
std::string risk_name(const std::string& teacher, double worst_share);

/// Profit of the day that one in twenty is not above, EUR per MWh of capacity; the worst one of
/// fewer than twenty. There must be a day.
double bad_day_eur_per_mwh(const Evaluation& evaluation);

/// Profit, bad day and worst day, SoC carried over, of the policy named `teacher` and of its
/// cautious twins; empty when there are none.
std::string risk_table(const std::vector<NamedEvaluation>& evaluations, const std::string& teacher);

}  // namespace bess
