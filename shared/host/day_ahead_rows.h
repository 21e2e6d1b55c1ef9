// Day-ahead prices of an answer, by local days. Most formats have no duration of a price, so it
// follows from the rows of a day:
//   their step (15, 30 or 60 minutes), which may differ between days
//   one hour for a row at the full hour with the next row one hour later
//   until the next row for larger distances: servers merge rows with equal prices, or miss rows.
//   Such prices are assumed, and the day is incomplete
// A row without a price means a missing price, without assumption.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"

namespace bess {

struct DayAheadRow {
  std::int64_t utc_s = 0;
  double eur_per_mwh = 0;            ///< NaN: none
  int resolution_min = 0;            ///< 0: unknown
  std::int64_t published_utc_s = 0;  ///< 0: unknown
};

/// Paths of names. `rows`: list of objects, each with time and price. Empty `rows`: `time` and
/// `price` are two lists of equal length, as of energy-charts.
struct DayAheadFields {
  std::string_view rows = "";
  std::string_view time = "unix_seconds";
  std::string_view price = "price";
};

struct DayAheadAnswer {
  std::vector<DayAheadRow> rows{};  ///< in the order of the answer, with and without a price
  int passed_over = 0;              ///< rows without a time
  std::string trouble{};            ///< error; then there are no rows
};

/// Values other than numbers (null, NaN, text) are no price. "unit", if present, must be EUR/MWh.
DayAheadAnswer parse_day_ahead_json(std::string_view text, const DayAheadFields& fields = {});

/// Sentinels such as -999 for "no price".
bool is_day_ahead_sentinel(double eur_per_mwh);

struct DayAheadQuarterHour {
  std::int64_t utc_s = 0;
  double eur_per_mwh = 0;
  int resolution_min = 0;  ///< of the row: 15, 30 or 60
  std::int64_t published_utc_s = 0;
  bool is_assumed = false;
};

struct DayAheadDay {
  std::int64_t midnight_utc_s = 0;
  std::vector<DayAheadQuarterHour> quarter_hours{};  ///< with a price, ascending
  int resolution_min = 0;  ///< longest of its rows; 60 also if each hour has one price
  /// One price over half a day or more: a placeholder, not a result of the auction.
  [[nodiscard]] bool is_constant() const;
};

struct DayAheadLayout {
  std::vector<DayAheadDay> days{};  ///< ascending
  std::string trouble{};  ///< error: a time that is not a quarter-hour; then there are no days
  /// First time with two prices, of which the later row counts; 0: none.
  std::int64_t contradiction_utc_s = 0;
  double contradicting_eur_per_mwh[2] = {};
};

/// Rows in any order. Needs the market's time zone.
DayAheadLayout lay_out_day_ahead(std::vector<DayAheadRow> rows);

}  // namespace bess
