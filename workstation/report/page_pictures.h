// The numbers of the pictures that the page's scripts draw and no other file of the run has: every
// step of its days, the maps as they open, the prices. Those of lost_page.h are its own; days,
// checkpoints and losses lie in evaluation_days.csv, training_curve.csv, student_checkpoints.csv
// and distil_curve.csv.
#pragma once

#include <vector>

#include "workstation/report/figures/picture_table.h"
#include "workstation/report/page_data.h"

namespace bess {

std::vector<PictureTable> page_pictures(const ReportInputs& inputs, const PageSteps& steps);

}  // namespace bess
