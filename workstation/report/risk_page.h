// The page's table of how the days of each policy scatter and fall (env/day_risk.h).
#pragma once

#include <string>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// Every day from the same SoC; gains over the first policy. Empty without days.
std::string risk_html(const std::vector<NamedEvaluation>& evaluations);

}  // namespace bess
