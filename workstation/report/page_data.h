// What the page's scripts draw, as JSON: every day of every policy, the steps of the days, the
// integer students, and how they were learned. page/*.js reads it.
#pragma once

#include "shared/host/json.h"
#include "workstation/report/report.h"
#include "workstation/report/step_archive.h"

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

/// What the run's own policies did on the test days.
struct PageSteps {
  std::vector<MarketDay> days;        ///< all test days
  std::vector<PolicySteps> policies;  ///< of all of them; the exported policy first
  std::vector<std::size_t> kept;      ///< indices of the days that the page holds, ascending
};
PageSteps page_steps(const ReportInputs& inputs);

/// What the page's map shows first: the class that most steps of the test days are in, at noon.
PolicyContext first_map(const ReportInputs& inputs);

Json page_data(const ReportInputs& inputs, const PageSteps& steps);

}  // namespace bess
