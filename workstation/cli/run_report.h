// The evaluation and the report of one run: shared by `run`, which has everything at hand, and `report`,
// which reads it back from the run's folder.
#pragma once

#include <string>
#include <vector>

#include "workstation/cli/run_config.h"
#include "workstation/cli/run_folder.h"
#include "workstation/report/curves.h"
#include "workstation/report/report.h"
#include "workstation/student/prove.h"

namespace bess {

struct RunResults {
  RunConfig config;
  MarketSteps market;
  Teacher teacher;
  Verdict plain;
  Verdict corrected;
  std::vector<CurvePoint> training_curve;
  std::vector<DistilPoint> distil_curve;
};

/// Test days, day reset and carried over: rule-based first, then the other baselines, the teacher, the
/// plain and the corrected student, and foresight last.
std::vector<NamedEvaluation> evaluate_run(const RunResults& run);

/// Writes evaluation.csv, the figures and report.html; returns the closing table for the terminal.
std::string write_run_report(const RunResults& run, const RunFolder& folder);

}  // namespace bess
