// The evaluation and the report of one run, from what its folder holds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/chain/run_config.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/report.h"
#include "workstation/run/run_folder.h"

namespace bess {

struct RunResults {
  const RunConfig& config;
  const MarketSteps& market;
  const Teacher& teacher;
  std::optional<StudentFile> plain;  ///< none of a lean run
  StudentFile corrected;             ///< both with the certificate of the proof that the run made
  std::vector<CurvePoint> training_curve;
  std::vector<DistilPoint> distil_curve;
  WalkForwardOfRun walk_forward;  ///< of the same prices and configuration
  std::vector<StudentCheckpoint> checkpoints = {};
};

/// Throws UserError, which names `prices`: asked before anything is trained.
void require_test_days(const MarketSteps& market, const std::string& prices);

/// Test days, day reset and carried over: rule-based first, then the other baselines, the teacher,
/// the plain and the corrected student, and foresight last. Without a plain student,
/// what stands on it is left out.
std::vector<NamedEvaluation> evaluate_run(const RunResults& run);

/// Precondition: there is a plain student. Writes the figures with their CSV files, report.html and
/// the summary; returns the names of all.
std::vector<std::string> write_run_report(const RunResults& run,
                                          const std::vector<NamedEvaluation>& evaluations,
                                          const RunFolder& folder);

}  // namespace bess
