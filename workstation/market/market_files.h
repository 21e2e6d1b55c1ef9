// Market files by name: downloads in any mixture, and settled quarter-hours for reconstruction.
#pragma once

#include <string>
#include <vector>

#include "workstation/market/market_join.h"

namespace bess {

/// All rows of all files, in their order.
MarketRows read_market_files(const std::vector<std::string>& paths);

/// Settled quarter-hours of the files, ascending; minute rows are an error that names the file.
std::vector<QuarterHour> read_quarter_hour_files(const std::vector<std::string>& paths);

}  // namespace bess
