// The report of a run: figures and one HTML page that holds them all, from results that the caller
// already has. Only what a figure needs and nobody kept is computed here: the rule-based
// validation profit, the teacher's map, and the records of one test day.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/correction/distil.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures.h"
#include "workstation/rl/train.h"
#include "workstation/student/student_file.h"

namespace bess {

struct ReportInputs {
  const MarketSteps& market;  ///< delay and settlement as trained
  BatteryParameters battery = {};
  std::vector<NamedEvaluation> evaluations = {};  ///< on the test days; the first is rule-based
  std::vector<CurvePoint> training_curve = {};    ///< may be empty
  std::vector<DistilPoint> distil_curve = {};     ///< may be empty
  const Teacher* teacher = nullptr;  ///< each pointer may be null: what it shows is left out
  const StudentFile* uncorrected = nullptr;  ///< both students with the prover's certificate
  const StudentFile* corrected = nullptr;
  std::vector<PolicyContext> maps = {
      {.context_class = 3, .quarter_hour = 48, .minute_of_quarter_hour = 7},
      {.context_class = 9, .quarter_hour = 48, .minute_of_quarter_hour = 7}};
  std::string provenance = {};  ///< lines, shown as they are
};

/// Writes the SVG figures and report.html into `folder`, which is created; each file appears
/// complete or not at all. Throws UserError without gnuplot or room to write.
void write_report(const ReportInputs& inputs, const std::filesystem::path& folder);

}  // namespace bess
