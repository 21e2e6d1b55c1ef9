// What stands below a comparison of policies: the same money for the whole battery, and why two
// lines are alike.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// A table of EUR per day of the whole battery, in both ways of counting. Empty without
/// evaluations.
std::string whole_battery_html(const std::vector<NamedEvaluation>& evaluations);
/// "the configured battery of 8 MWh: the corrected student 4,908.8 EUR a day ..." and line end;
/// empty without that student.
std::string whole_battery_text(const std::vector<NamedEvaluation>& evaluations);

/// "sdp and sdp teacher are ...", where both earned the same on every day, to the bit: a teacher of
/// the stochastic program asks the very program that the baseline is, and so does a residual one
/// whose validation kept step 0. Empty otherwise.
std::string same_program_text(const std::vector<NamedEvaluation>& evaluations);

}  // namespace bess
