// Day-ahead rows: published prices in several formats to one series of quarter-hours.
//   ENTSO-E A44 (Publication_MarketDocument), curveType A03 or A01, PT15M to PT60M
//   energy-charts: {"unix_seconds": [...], "price": [...], "unit": "EUR / MWh"}
//   CSV with a time and a price column, and the files that this program writes
// Hourly and half-hourly prices are repeated in their quarter-hours and marked, with the layout of
// the edge (shared/host/day_ahead_rows.h). Quarter-hours that this layout only assumes are omitted:
// models are trained on published prices only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

/// Rows of a file and its metadata.
struct DayAheadFile {
  std::vector<DayAheadRow> rows{};
  std::string zone{};    ///< EIC of the bidding zone; empty: unknown
  std::string unused{};  ///< description of omitted rows; empty: none
};

/// Detects the format by content. Throws UserError naming the place.
DayAheadFile parse_day_ahead_text(std::string_view text, std::string_view name);
/// Uses the day-ahead auction (lowest sequence) if a zone has two auctions. Throws UserError naming
/// the line, also for two zones.
DayAheadFile parse_entsoe_day_ahead(std::string_view text, std::string_view name);
std::vector<DayAheadRow> parse_energy_charts(std::string_view text, std::string_view name);

/// Rows of several files. Throws UserError naming two files with different zones.
std::vector<DayAheadRow> rows_of_one_zone(const std::vector<std::string>& paths,
                                          std::vector<std::string>& notes);

struct JoinedDayAhead {
  DayAheadSeries series;
  std::vector<Finding>
      findings;  ///< contradicting rows of one time: `overlap`; the later one counts
  std::size_t repeated_hours = 0;
  std::size_t assumed = 0;        ///< merged or missing quarter-hours, omitted
  std::size_t constant_days = 0;  ///< with a constant price, omitted
};

/// Rows in any order; `name` is used in messages. Needs the market's time zone. Throws UserError
/// without rows, or for a row that does not start a quarter-hour.
JoinedDayAhead join_day_ahead(std::vector<DayAheadRow> rows, std::string_view name);

/// "8760 quarter-hours in 92 days, from ... to ...", repeated hours, incomplete and constant days.
std::string describe_day_ahead(const JoinedDayAhead& joined);

}  // namespace bess
