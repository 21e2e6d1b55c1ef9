// Report of a run: one self-contained HTML page, and CSV files of its pictures. Computes only the
// rule-based validation profit and the steps of the test days; other results come from the caller.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/policy/rl/train.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/walk_forward_figure.h"
#include "workstation/report/report_tables.h"

namespace bess {

/// Results of a run, for its evaluation and report.
struct RunResults {
  const MarketSteps& market;  ///< delay and settlement as trained
  BatteryParameters battery = {};
  double initial_soc_frac = 0.5;                    ///< at the start of each test day
  std::vector<NamedEvaluation> evaluations = {};    ///< on the test days; rule-based first
  std::vector<CurvePoint> training_curve = {};      ///< may be empty
  std::vector<DistilPoint> distil_curve = {};       ///< may be empty
  std::vector<StudentCheckpoint> checkpoints = {};  ///< of the corrected student; may be empty
  const Teacher& teacher;
  std::optional<StudentFile> plain = {};  ///< none in a lean run, which has no report
  StudentFile corrected;                  ///< both students with the run's certificate
  std::vector<BrokenDemand> broken = {};  ///< of an unproved student
  WalkForwardOfRun walk_forward = {};
  Entries facts = {};  ///< date, host, inputs and command
};

/// Precondition: there is a plain student. Writes report.html and a CSV file for each picture into
/// `folder` atomically; returns their names. Throws UserError when writing fails, or without test
/// days.
std::vector<std::string> write_report(const RunResults& run, const std::filesystem::path& folder);

}  // namespace bess
