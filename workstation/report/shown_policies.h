// The policies of a run's own chain, whose steps the report shows: corrected student (or the
// unproved one), plain student, teacher.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "workstation/report/report.h"

namespace bess {

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
