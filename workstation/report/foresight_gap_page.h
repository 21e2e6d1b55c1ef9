// Page section on the profit gap: by cause, by hour and month, and the worst days.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/figures/picture_table.h"
#include "workstation/report/foresight_gap.h"
#include "workstation/report/report.h"

namespace bess {

/// Losses of the exported policy over the test days.
std::vector<DayLoss> losses_of(const ReportInputs& inputs);

/// EUR per MWh of capacity.
std::string foresight_gap_html(const std::vector<DayLoss>& losses, double capacity_mwh);

/// Data of foresight_gap_html: lost_causes, lost_hours, lost_days (all days).
std::vector<PictureTable> foresight_gap_tables(const std::vector<DayLoss>& losses,
                                               double capacity_mwh);

}  // namespace bess
