// The page's chapter on what was missed: by cause, by hour and month, and the worst days with their
// causes.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/figures/picture_table.h"
#include "workstation/report/lost_money.h"
#include "workstation/report/report.h"

namespace bess {

/// Of the exported policy over the test days, or of what there is of its chain; empty without any
/// student.
std::vector<DayLoss> losses_of(const ReportInputs& inputs);

/// Days in the order of what was missed, the worst first.
std::vector<const DayLoss*> by_missed(const std::vector<DayLoss>& losses);

/// Empty without losses. Money in EUR per MWh of capacity.
std::string lost_html(const std::vector<DayLoss>& losses, double capacity_mwh);

/// What lost_html draws: lost_causes, lost_hours, lost_days (of all days).
std::vector<PictureTable> lost_tables(const std::vector<DayLoss>& losses, double capacity_mwh);

}  // namespace bess
