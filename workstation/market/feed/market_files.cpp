#include "workstation/market/feed/market_files.h"

#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/market/feed/market_text.h"
#include "workstation/market/feed/overlap.h"

namespace bess {
namespace {

/// Not an overload: {kElia} would mean this one where files are compiled together.
const char* words_for(MarketSource source) {
  switch (source) {
    case MarketSource::kElia:
      return "Elia, opendata.elia.be, CC BY 4.0 (https://creativecommons.org/licenses/by/4.0/)";
    case MarketSource::kEntsoe:
      return "ENTSO-E Transparency Platform, transparency.entsoe.eu, by its terms of use";
    case MarketSource::kSimulated:
      return "a simulated market of bess-train, not real";
    case MarketSource::kDrawn:
      return "minutes by bess-train prices reconstruct: drawn, not real";
    case MarketSource::kUnknown:
      break;
  }
  return "a file that does not name its source";
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  std::string text;
  for (const std::string& part : parts) text.append(text.empty() ? "" : separator).append(part);
  return text;
}

}  // namespace

MarketRows read_market_files(const std::vector<std::string>& paths, const OwnForm& own) {
  MarketRows all;
  Overlap overlap;
  for (const std::string& path : paths) {
    const MarketRows rows = parse_market_text(read_file(path), path, own);
    if (rows.is_minute_file) overlap.add(path, rows);
    append_rows(all, rows);
  }
  all.findings = overlap.findings();
  return all;
}

SettledQuarterHours read_quarter_hour_files(const std::vector<std::string>& paths) {
  MarketRows rows = read_market_files(paths);
  if (rows.quarter_hours.empty() && !rows.minutes.empty()) {
    fail(
        "{}: holds minute rows without settled prices; give settled quarter-hours (ods047, ods134)",
        joined(paths, ", "));
  }
  if (rows.quarter_hours.empty()) fail("{}: holds no rows", joined(paths, ", "));
  SettledQuarterHours settled;
  settled.sources = rows.sources;
  settled.sources.erase(MarketSource::kDrawn);  // of the minutes, which are drawn anew
  settled.minutes_unused = rows.minutes.size();
  settled.report.findings = std::move(rows.findings);
  settled.report.dual_priced_quarter_hours = rows.dual_priced_quarter_hours.size();
  settled.quarter_hours = sorted_quarter_hours(std::move(rows.quarter_hours), settled.report);
  check_span(settled.quarter_hours.front().utc_s, settled.quarter_hours.back().utc_s,
             paths.front());
  return settled;
}

std::string file_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    names.push_back(std::filesystem::path(path).filename().string());
  }
  return joined(names, ", ");
}

std::string attribution_of(const std::set<MarketSource>& sources) {
  std::vector<std::string> names;
  for (const MarketSource source : sources) names.emplace_back(words_for(source));
  return "Source: " + joined(names, "; ");
}

}  // namespace bess
