// Market files by name: downloads in any mixture, and settled quarter-hours for reconstruction.
#pragma once

#include <string>
#include <vector>

#include "workstation/market/feed/market_csv.h"
#include "workstation/market/feed/market_join.h"

namespace bess {

/// All rows of all files, in their order; `own` is how CSV of one's own is read.
MarketRows read_market_files(const std::vector<std::string>& paths, const OwnForm& own = {});

struct SettledQuarterHours {
  std::vector<QuarterHour> quarter_hours;  ///< ascending
  std::set<MarketSource> sources;
  JoinReport report;
  std::size_t minutes_unused = 0;  ///< minute rows of the files
};

/// Settled quarter-hours of the files; those of a minute file have no system imbalance. Throws
/// UserError when there are none.
SettledQuarterHours read_quarter_hour_files(const std::vector<std::string>& paths);

/// File names without their folders, for a provenance.
std::string file_names(const std::vector<std::string>& paths);

/// One line that names whose data it is, as the licences ask.
std::string attribution_of(const std::set<MarketSource>& sources);

}  // namespace bess
