// The report of a run: one HTML page that needs nothing beside it, and the numbers of its pictures
// as CSV files, from results that the caller already has. Only what nobody kept is computed here:
// the rule-based validation profit, and the steps of the test days.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_checkpoints.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/policy/rl/train.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/policy_map.h"
#include "workstation/report/figures/walk_forward_figure.h"
#include "workstation/report/report_tables.h"

namespace bess {

struct ReportInputs {
  const MarketSteps& market;  ///< delay and settlement as trained
  BatteryParameters battery = {};
  double initial_soc_frac = 0.5;                    ///< with which each test day starts
  std::vector<NamedEvaluation> evaluations = {};    ///< on the test days; the first is rule-based
  std::vector<CurvePoint> training_curve = {};      ///< may be empty
  std::vector<DistilPoint> distil_curve = {};       ///< may be empty
  std::vector<StudentCheckpoint> checkpoints = {};  ///< of the corrected student; may be empty
  const Teacher* teacher = nullptr;  ///< each pointer may be null: what it shows is left out
  const StudentFile* uncorrected = nullptr;  ///< both students with the prover's certificate
  const StudentFile* corrected = nullptr;
  std::vector<BrokenDemand> broken = {};  ///< of a corrected student that was not proved
  WalkForwardOfRun walk_forward = {};
  std::string provenance = {};   ///< lines, shown as they are
  std::vector<Fact> facts = {};  ///< when, where, from what and how
};

/// Of what there is: corrected student's, uncorrected student's, teacher's.
ContextClasses context_classes_of(const ReportInputs& inputs);
/// The class of a step; by outlook that of a battery in the middle of its SoC window.
int context_class_of(const ReportInputs& inputs, const MarketStep& step);
/// What the students were checked against.
PriceThresholds thresholds_of(const ReportInputs& inputs);

/// Whose counterexamples are shown: the corrected student's when it has any, else the uncorrected
/// one's; may be null.
const StudentFile* shown_as_wrong(const ReportInputs& inputs);
/// What it is called on the page.
const char* shown_as_wrong_name(const ReportInputs& inputs);

/// Writes report.html and the CSV file of each picture into `folder`, which is created; each file
/// appears complete or not at all. Returns the names of all of them. Throws UserError without room
/// to write, or without test days.
std::vector<std::string> write_report(const ReportInputs& inputs,
                                      const std::filesystem::path& folder);

}  // namespace bess
