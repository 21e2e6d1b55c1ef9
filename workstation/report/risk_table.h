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

/// One way of choosing, and what it did, SoC carried over.
struct RiskChoice {
  std::string name;  ///< "mean", "cvar:0.1"
  const Evaluation* evaluation;
};

/// The policy named `teacher` and its cautious twins; empty when there are none. `evaluations` must
/// outlive them.
std::vector<RiskChoice> risk_choices(const std::vector<NamedEvaluation>& evaluations,
                                     const std::string& teacher);

/// Their profit, bad day and worst day; empty when there are no twins.
std::string risk_table(const std::vector<NamedEvaluation>& evaluations, const std::string& teacher);
/// The same for the page.
std::string risk_choice_html(const std::vector<NamedEvaluation>& evaluations,
                             const std::string& teacher);

}  // namespace bess
