// Market files by name: downloads in any mixture, and settled quarter-hours for reconstruction.
#pragma once

#include <string>
#include <vector>

#include "workstation/market/feed/market_join.h"

namespace bess {

/// All rows of all files, in their order.
MarketRows read_market_files(const std::vector<std::string>& paths);

struct SettledQuarterHours {
  std::vector<QuarterHour> quarter_hours;  ///< ascending
  std::set<MarketSource> sources;
  JoinReport report;
};

/// Settled quarter-hours of the files; minute rows are an error.
SettledQuarterHours read_quarter_hour_files(const std::vector<std::string>& paths);

/// File names without their folders, for a provenance.
std::string file_names(const std::vector<std::string>& paths);

/// One line that names whose data it is, as the licences ask.
std::string attribution_of(const std::set<MarketSource>& sources);

}  // namespace bess
