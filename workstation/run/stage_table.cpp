#include "workstation/run/stage_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "workstation/run/run_folder.h"

namespace bess {

std::span<const Stage> run_stages() {
  using namespace run_file;
  static const Stage kRows[] = {
      {stage_name::kConfiguration, 1, "", {}, {kConfig}},
      {stage_name::kPrices, 1, "", {}, {kSimulatedPrices}},
      {stage_name::kTeacher,
       2,
       "train the teacher, or take it",
       {},
       {kTeacher, kTrainingCurve, kCheckpoint}},
      {stage_name::kPlain,
       3,
       "distil without correction, for comparison",
       {kTeacher},
       {kPlainStudent, kPlainViolations}},
      {stage_name::kCorrected,
       4,
       "correct while distilling, and prove",
       {kTeacher},
       {kStudent, kUnprovedStudent, kUnprovedViolations, kDistilCurve, kProofRounds, kCheckpoints}},
      {stage_name::kHeader, 5, "export", {kStudent}, {run_file::kHeader}},
      {stage_name::kEvaluation,
       6,
       "evaluate on test days and report",
       {kTeacher, kPlainStudent, kStudent},
       {kTable, kDays}},
      {stage_name::kReport,
       6,
       "",
       {kTeacher, kPlainStudent, kPlainViolations, kStudent, kTrainingCurve, kDistilCurve, kDays},
       {kSummary, run_file::kReport}},
      {stage_name::kFailureReport,
       6,
       "report where the proof failed",
       {kTeacher, kPlainStudent, kPlainViolations, kUnprovedStudent},
       {kSummary, run_file::kReport}},
  };
  return kRows;
}

const Stage& stage_named(std::string_view name) {
  return *std::ranges::find(run_stages(), name, &Stage::name);
}

int stage_count() { return run_stages().back().number; }

std::vector<std::string> run_files() {
  std::vector<std::string> files{run_file::kRecord, run_file::kTimes};
  for (const Stage& stage : run_stages()) {
    for (const std::string& file : stage.outputs) {
      if (std::ranges::find(files, file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

std::string stages_help() {
  std::string text;
  for (const Stage& stage : run_stages()) {
    text +=
        fmt::format("  {}  {:<26}  {}\n", stage.number, stage.name, fmt::join(stage.outputs, ", "));
  }
  return text;
}

}  // namespace bess
