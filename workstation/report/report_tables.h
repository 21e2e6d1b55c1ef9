// Tables and notes of the report's page: what each policy earned, what was proved, provenance.
#pragma once

#include <string>
#include <vector>

#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/prove.h"
#include "workstation/report/comparison.h"
#include "workstation/report/rule_prices.h"

namespace bess {

// A line of what a page says about where it comes from.

struct Fact {
  std::string name;
  std::string value;
};

// What stands below a comparison of policies: the same money for the whole battery, and why two
// lines are alike.

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

/// Both ways of counting, each left out when nothing was evaluated that way; with what the columns
/// mean.
std::string comparison_html(const std::vector<NamedEvaluation>& evaluations);

/// Violations before and after; either may be null.
std::string proof_html(const Certificate* uncorrected, const Certificate* corrected);
/// Where a proof failed, demand by demand; empty when none is broken. A button has the index of its
/// demand as data-broken.
std::string failure_html(const std::vector<BrokenDemand>& broken);
/// "Proved: ..." or why the student may not be exported.
std::string proof_sentence(const Certificate& certificate);

/// The operator's rules: what each asks, who is held to it, who breaks it how often, and what it
/// costs. Empty without rules; `kind` is the students' context; `prices` may be null.
std::string rules_html(const Certificate* uncorrected, const Certificate* corrected,
                       ContextKind kind, const RulePrices* prices);

/// Names and values, and below them `lines` as they are.
std::string provenance_html(const std::vector<Fact>& facts, const std::string& lines);

/// 6,950,033,280
std::string grouped(std::int64_t count);

}  // namespace bess
