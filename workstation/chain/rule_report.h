// What a proof found of an operator's rules, in lines and in JSON.
#pragma once

#include <string>

#include "shared/host/json.h"
#include "workstation/chain/run_config.h"
#include "workstation/student/student_file.h"

namespace bess {

/// A line a rule: violations, or that it is the guard's alone. Empty without rules.
std::string rule_count_lines(const Certificate& certificate);

/// "rules": a list of objects; nothing without rules.
void add_certificate(const Certificate& certificate, Json& json);

/// Of each broken rule the worst state, and the share of decisions on the days of `market` that
/// break it, the SoC carried over; without days there is no share.
std::string broken_rule_lines(const StudentFile& student, const MarketSteps& market,
                              const RunConfig& config);

}  // namespace bess
