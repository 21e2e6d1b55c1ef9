#include "workstation/market/market_files.h"

#include "workstation/io/file.h"
#include "workstation/io/user_error.h"

namespace bess {

MarketRows read_market_files(const std::vector<std::string>& paths) {
  MarketRows all;
  for (const std::string& path : paths) {
    const MarketRows rows = parse_market_text(read_file(path), path);
    all.minutes.insert(all.minutes.end(), rows.minutes.begin(), rows.minutes.end());
    all.quarter_hours.insert(all.quarter_hours.end(), rows.quarter_hours.begin(),
                             rows.quarter_hours.end());
    all.dual_priced += rows.dual_priced;
  }
  return all;
}

std::vector<QuarterHour> read_quarter_hour_files(const std::vector<std::string>& paths) {
  MarketRows rows = read_market_files(paths);
  if (!rows.minutes.empty()) {
    fail("{}: holds minute rows; give settled quarter-hours (ods047, ods134)", paths.front());
  }
  if (rows.quarter_hours.empty()) fail("{}: holds no rows", paths.front());
  JoinReport report;
  std::vector<QuarterHour> sorted = sorted_quarter_hours(std::move(rows.quarter_hours), report);
  check_span(sorted.front().utc_s, sorted.back().utc_s, paths.front());
  return sorted;
}

}  // namespace bess
