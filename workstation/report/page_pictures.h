// The numbers of every picture that the page's scripts draw, wear as configured: page/*.js computes
// them once more from the page's data, and a browser test holds the two against each other. Those
// of lost_page.h are its own.
#pragma once

#include <vector>

#include "workstation/report/figures/picture_table.h"
#include "workstation/report/page_data.h"

namespace bess {

std::vector<PictureTable> page_pictures(const ReportInputs& inputs, const PageSteps& steps);

}  // namespace bess
