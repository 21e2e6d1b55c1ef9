// What of a value distribution an action is chosen by: the mean, or the mean of its worst share
// (conditional value at risk, CVaR). Decisions only: training always follows the mean.
#pragma once

#include <string_view>

#include "workstation/rl/support.h"

namespace bess {

struct Risk {
  double worst_share = 1;  ///< alpha of CVaR; 1 is the mean
  [[nodiscard]] bool is_mean() const { return worst_share >= 1; }
};

/// "mean" or "cvar:ALPHA", 0 < ALPHA <= 1. Throws UserError.
Risk parse_risk(std::string_view text);

/// Mean of the lowest `alpha` of a distribution over ascending atoms,
///   CVaR_alpha = 1/alpha * sum_i min(p_i, what alpha still lacks) z_i   [Rockafellar, Uryasev 2000]
double conditional_value_at_risk(const Support& support, const float* probability, double alpha);

}  // namespace bess
