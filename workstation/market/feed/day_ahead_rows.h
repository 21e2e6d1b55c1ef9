// Day-ahead prices as they are published, whatever their form, to one series of quarter-hours:
//   ENTSO-E A44 (Publication_MarketDocument), curveType A03 or A01, PT15M to PT60M
//   energy-charts: {"unix_seconds": [...], "price": [...], "unit": "EUR / MWh"}
//   CSV with a time and a price column, and the files that this program writes
// Prices of hours or half hours are repeated in their quarter-hours and marked as such. Elsewhere
// than in A44 nothing says how long a price holds: until the next row, by the shortest distance of
// the local day. A day of quarter-hours whose hours have one price each is one of hours, which
// somebody repeated before.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/market/series/day_ahead.h"
#include "workstation/market/series/plausibility.h"

namespace bess {

struct DayAheadRow {
  std::int64_t utc_s;
  double eur_per_mwh;
  int resolution_min = 0;            ///< 0: not said
  std::int64_t published_utc_s = 0;  ///< 0: not said
};

/// Any of them, told apart by its content. Throws UserError naming the place.
std::vector<DayAheadRow> parse_day_ahead_text(std::string_view text, std::string_view name);
/// Throw UserError naming the line, or the entry.
std::vector<DayAheadRow> parse_entsoe_day_ahead(std::string_view text, std::string_view name);
std::vector<DayAheadRow> parse_energy_charts(std::string_view text, std::string_view name);
std::vector<DayAheadRow> parse_tidy_day_ahead(std::string_view text, std::string_view name);

struct JoinedDayAhead {
  DayAheadSeries series;
  std::vector<Finding>
      findings;  ///< rows of one time that disagree: `overlap`; the later one counts
  std::size_t repeated_hours = 0;
};

/// In any order; `name` is used in messages. Needs the market's time zone. Throws UserError when
/// there is no row, or a day's rows do not come every 15, 30 or 60 minutes.
JoinedDayAhead join_day_ahead(std::vector<DayAheadRow> rows, std::string_view name);

/// "8760 quarter-hours in 92 days, from ... to ...", hours that are repeated, days that are not
/// complete.
std::string describe_day_ahead(const JoinedDayAhead& joined);

}  // namespace bess
