// The operator's rules in the exported header: what was proved of them, for people; the rule file's
// text, so that the proof can be made again; and what the guard enforces, as constant tables with
// golden points. Without rules nothing is written.
#pragma once

#include <string>

#include "workstation/student/prove.h"

namespace bess {

/// Behind the three properties, a line each; empty without rules.
std::string rule_lines(const Certificate& certificate);

/// Macros and tables; empty without rules.
std::string rule_section(const ProvedStudent& student);

/// Points at which each field of each rule shows: inside its box, at its ends, and just beyond.
std::vector<RulePoint> rule_check_points(const std::vector<GuardRule>& rules);

}  // namespace bess
