// What the page's scripts draw, as JSON: every day of every policy, the steps of the days, the
// integer students, and how they were learned. page/*.js reads it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/report/figures/picture_table.h"
#include "workstation/report/report.h"
#include "workstation/report/step_archive.h"

namespace bess {

// The operator's rules as the page draws and counts them (page/rule_boxes.js): where each holds on
// the lattice, what it asks, and who is held to it.

/// A list of objects, one a rule, in order:
///   name, text, held_by, binds_student
///   hours      [first quarter-hour, how many], past midnight too
///   classes    bit c - 1, of the student's context; all where it does not see the months of
///              the rule
///   soc        [first, last] lattice index
///   price      [first, last] EUR/MWh of the lattice; left out for a rule that lies outside it
///   forbidden  actions that break it; left out for what no single state breaks, and for
///              thresholds, which are properties 1 and 2
///   direction  {input, sign} as Direction has them; of such a rule alone, which has no box
Json rules_json(const RuleSet& rules, ContextKind kind);

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

// The numbers of the pictures that the page's scripts draw and no other file of the run has: every
// step of its days, the maps as they open, the prices. Those of lost_page.h are its own; days,
// checkpoints and losses lie in evaluation_days.csv, training_curve.csv, student_checkpoints.csv
// and distil_curve.csv.

std::vector<PictureTable> page_pictures(const ReportInputs& inputs, const PageSteps& steps);

// The policies of a run's own chain, whose steps the report shows: corrected student (or the
// unproved one), plain student, teacher.

struct ShownPolicy {
  std::string name;
  std::unique_ptr<Policy> policy;
};

/// What a run's teacher is called: "c51 teacher".
std::string teacher_name(const Teacher& teacher);

/// What a run's own student is called: kCorrectedName, or kUnprovedName with violations left.
const char* own_student_name(const Certificate& certificate);

/// Those that there are, the last link of the chain first; without any, the paper's rule. `inputs`
/// must outlive them.
std::vector<ShownPolicy> shown_policies(const ReportInputs& inputs);

/// What the paper's rule earns on the validation days as a teacher is judged there, charge carried
/// over.
double rule_validation_profit(const MarketSteps& market, const BatteryParameters& battery);

}  // namespace bess
