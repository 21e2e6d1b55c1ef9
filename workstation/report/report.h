// Report of a run: one self-contained HTML page, and CSV files of its pictures. Computes only the
// rule-based validation profit and the steps of the test days; other results come from the caller.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/prove.h"
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
  double initial_soc_frac = 0.5;                    ///< at the start of each test day
  std::vector<NamedEvaluation> evaluations = {};    ///< on the test days; rule-based first
  std::vector<CurvePoint> training_curve = {};      ///< may be empty
  std::vector<DistilPoint> distil_curve = {};       ///< may be empty
  std::vector<StudentCheckpoint> checkpoints = {};  ///< of the corrected student; may be empty
  const Teacher* teacher = nullptr;                 ///< null pointers are omitted
  const StudentFile* uncorrected = nullptr;         ///< both students with their certificate
  const StudentFile* corrected = nullptr;
  std::vector<BrokenDemand> broken = {};  ///< of an unproved student
  WalkForwardOfRun walk_forward = {};
  std::string provenance = {};             ///< shown unchanged
  std::vector<ProvenanceLine> facts = {};  ///< date, host, inputs and command
};

/// Of the corrected student, else the uncorrected student, else the teacher.
ContextClasses context_classes_of(const ReportInputs& inputs);
/// Class of a step; by outlook for a battery in the middle of its SoC window.
int context_class_of(const ReportInputs& inputs, const MarketStep& step);
/// Price thresholds of the proof.
PriceThresholds thresholds_of(const ReportInputs& inputs);

/// Student whose counterexamples are shown: the corrected one if it has any, else the uncorrected
/// one; may be null.
const StudentFile* shown_as_wrong(const ReportInputs& inputs);
/// Its name on the page.
const char* shown_as_wrong_name(const ReportInputs& inputs);

/// Writes report.html and a CSV file for each picture into `folder` atomically; returns their
/// names. Throws UserError when writing fails, or without test days.
std::vector<std::string> write_report(const ReportInputs& inputs,
                                      const std::filesystem::path& folder);

}  // namespace bess
