// Finished runs as figures: what `run --json` prints and `runs compare` lines up.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/comparison.h"
#include "workstation/report/judged_days.h"
#include "workstation/run/run_record.h"

namespace bess {

/// The policy that a run is about: what would be exported.
inline constexpr const char* kExportedPolicy = "corrected student";

struct RunSummary {
  RunFolder folder;
  RunRecord record;
  std::vector<NamedEvaluation> evaluations;
};

/// The days that it is judged by.
JudgedDays judged_days_of(const RunSummary& run);

/// Throws UserError when there is no run or it is not finished, saying how to go on.
RunSummary load_run_summary(const RunFolder& folder);

/// One object: the run, its figures and every policy in both ways of counting.
Json summary_json(const RunSummary& run);

/// The value of a key for people, in one line; rules by what they say.
std::string value_text(const RunRecord& record, const std::string& key);
/// The keys, of any run, of which the runs have not all the same value.
std::vector<std::string> differing_keys(const std::vector<const RunRecord*>& runs);

/// A line a run, and what the runs differ in.
std::string format_runs_table(const std::vector<RunSummary>& runs);

}  // namespace bess
