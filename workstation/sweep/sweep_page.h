// A sweep on one page, which needs nothing that is installed and no network: settings with seeds
// and months folded, a heat map over two of them, profit against cycles, and every task; each table
// sorts by its heads.
#pragma once

#include <string>
#include <vector>

#include "workstation/sweep/collected.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {

/// `axes`: the two settings of the map; empty: the first two that vary. Throws UserError when one
/// of them does not vary, naming those that do.
std::string sweep_page(const SweepRecord& record, const std::vector<CollectedTask>& tasks,
                       const std::vector<CollectedSite>& sites, std::vector<std::string> axes);

}  // namespace bess
