// Day-ahead prices as they are published, whatever their form, to one series of quarter-hours:
//   ENTSO-E A44 (Publication_MarketDocument), curveType A03 or A01, PT15M to PT60M
//   energy-charts: {"unix_seconds": [...], "price": [...], "unit": "EUR / MWh"}
//   CSV with a time and a price column, and the files that this program writes
// Prices of hours or half hours are repeated in their quarter-hours and marked as such, by the
// layout that the edge uses too (shared/host/day_ahead_rows.h). What that assumes is left out here:
// a model is trained on published prices alone.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/day_ahead_rows.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

/// The rows of a file, and what it says about all of them.
struct DayAheadFile {
  std::vector<DayAheadRow> rows{};
  std::string zone{};    ///< EIC of the bidding zone; empty: not said
  std::string unused{};  ///< what was left out on purpose, in words; empty: nothing
};

/// Any of them, told apart by its content. Throws UserError naming the place.
DayAheadFile parse_day_ahead_text(std::string_view text, std::string_view name);
/// Of two auctions of one zone the day-ahead auction's prices count, those with the lowest
/// sequence. Throws UserError naming the line; also of two zones.
DayAheadFile parse_entsoe_day_ahead(std::string_view text, std::string_view name);
std::vector<DayAheadRow> parse_energy_charts(std::string_view text, std::string_view name);
std::vector<DayAheadRow> parse_tidy_day_ahead(std::string_view text, std::string_view name);

/// The rows of several files. Throws UserError naming two files of two zones.
std::vector<DayAheadRow> rows_of_one_zone(const std::vector<std::string>& paths,
                                          std::vector<std::string>& notes);

struct JoinedDayAhead {
  DayAheadSeries series;
  std::vector<Finding>
      findings;  ///< rows of one time that disagree: `overlap`; the later one counts
  std::size_t repeated_hours = 0;
  std::size_t assumed = 0;  ///< quarter-hours that may be merged rows, or missing ones: left out
  std::size_t constant_days = 0;  ///< of one price all day: left out
};

/// In any order; `name` is used in messages. Needs the market's time zone. Throws UserError when
/// there is no row, or a row is no quarter-hour's.
JoinedDayAhead join_day_ahead(std::vector<DayAheadRow> rows, std::string_view name);

/// "8760 quarter-hours in 92 days, from ... to ...", hours that are repeated, days that are not
/// complete or of one price.
std::string describe_day_ahead(const JoinedDayAhead& joined);

}  // namespace bess
