// Page of many runs: profit, proof, rules and settings, with a link to each run's report. Failed,
// stopped and edited runs are listed with their state.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "workstation/runs/run/run_report.h"

namespace bess {

struct RunLine {
  RunFolder folder;
  RunRecord record;
  std::optional<RunSummary> summary;  ///< of a finished, unedited run
  std::string trouble;                ///< why there is none, without a full stop
};

/// Throws UserError when the folder contains no run.
RunLine load_run_line(const RunFolder& folder);

/// Gains are over the first finished run. Links are relative to the folder of `page`.
std::string runs_page(const std::vector<RunLine>& runs, const std::filesystem::path& page);

}  // namespace bess
