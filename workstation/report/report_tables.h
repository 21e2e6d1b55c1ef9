// Tables and notes of the report page: profits, proof and provenance.
#pragma once

#include <string>
#include <vector>

#include "workstation/base/answer.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/prove.h"
#include "workstation/report/comparison.h"
#include "workstation/report/headline.h"

namespace bess {

// Notes below a comparison: profits of the whole battery, and equal policies.

/// Table of EUR per day for the whole battery, in both accountings. Empty without evaluations.
std::string whole_battery_html(const std::vector<NamedEvaluation>& evaluations);
/// "the configured battery of 8 MWh: the corrected student 4,908.8 EUR a day ..." and line end;
/// empty without that student.
std::string whole_battery_text(const std::vector<NamedEvaluation>& evaluations);

/// "sdp and sdp teacher are ..." when both have bit-identical profits on every day: an SDP teacher
/// is the baseline itself, and so is a residual teacher with step 0 selected. Else empty.
std::string same_program_text(const std::vector<NamedEvaluation>& evaluations);

/// Available accountings, with the meaning of the columns.
std::string comparison_html(const std::vector<NamedEvaluation>& evaluations);

/// Violations before and after.
std::string proof_html(const Certificate& uncorrected, const Certificate& corrected);
/// Broken demands of a failed proof; empty if none. Buttons have the index of the demand as
/// data-broken.
std::string failure_html(const std::vector<BrokenDemand>& broken);
/// "Proved: ..." or the violations that prevent export.
std::string proof_sentence(const Certificate& certificate);

/// Operator rules with demand, scope, violations and cost. Empty without rules; `kind` is the
/// students' context; `prices` may be null.
std::string rules_html(const Certificate& uncorrected, const Certificate& corrected,
                       ContextKind kind, const RulePrices* prices);

/// Names and values, then `lines` unchanged.
std::string provenance_html(const Entries& facts, const std::string& lines);

/// 6,950,033,280
std::string grouped(std::int64_t count);

}  // namespace bess
