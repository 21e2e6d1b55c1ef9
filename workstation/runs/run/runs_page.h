// Many runs on one page: what each earned, whether it was proved, its rules, what they differ in,
// and a link to each one's own page. A run that failed, was stopped or whose numbers were edited is
// a line too, with what became of it.
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
  std::optional<RunSummary> summary;  ///< of a finished run whose numbers are those that it wrote
  std::string trouble;                ///< why there is none, in a sentence without its full stop
};

/// Throws UserError when the folder holds no run.
RunLine load_run_line(const RunFolder& folder);

/// Gains are over the first run that has figures. Links are relative to the folder of `page`.
std::string runs_page(const std::vector<RunLine>& runs, const std::filesystem::path& page);

}  // namespace bess
