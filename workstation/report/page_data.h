// What the page's scripts draw, as JSON: every day of every policy, the steps of the days, the integer students,
// and how they were learned. page/*.js reads it.
#pragma once

#include "shared/host/json.h"
#include "workstation/report/report.h"

namespace bess {

/// Days whose steps a page holds at most: it stays under 5 MB. The worst and the newest are kept.
inline constexpr std::size_t kDaysWithSteps = 250;
/// Of these, the days on which the exported policy missed most of what foresight would have earned.
inline constexpr std::size_t kWorstDaysKept = 25;

/// Indices of the days to keep, ascending; `profit_eur` of each of them, in time.
std::vector<std::size_t> days_with_steps(const std::vector<double>& profit_eur, std::size_t most);

/// The integers of a net as the page evaluates it, and what its inputs are scaled by.
Json student_json(const StudentNet& net);
Json lattice_json();

Json page_data(const ReportInputs& inputs);

}  // namespace bess
