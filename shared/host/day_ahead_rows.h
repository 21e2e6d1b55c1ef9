// Day-ahead prices as an answer has them, laid out by local days. Most forms do not say how long a
// price holds, so the rows of a day say it:
//   by their step (15, 30 or 60 minutes), which may differ from day to day
//   a row at the full hour with the next one an hour later is an hour's price
//   until the next row where rows are further apart: servers merge rows that repeat a price, and
//   servers miss rows. Such prices are assumed, and the day is not whole
// A row without a price says that the price is missing: nothing is assumed there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"

namespace bess {

// Answers of price servers as JSON: what cJSON alone does not say. Names that stand twice in an
// object are ambiguous and count as absent; NaN and Infinity count as null.

/// Does not exist when `text` is anything else than one JSON value. Python and JavaScript write NaN
/// and Infinity, which are no JSON.
Json parse_answer(std::string_view text);

/// The value at "a.b.c" below an object; "" is the object itself.
JsonValue value_at(JsonValue object, std::string_view path);

/// UTC seconds: text with an offset (2023-03-26T01:02:00+00:00), or a number of seconds or
/// milliseconds since 1970.
std::optional<std::int64_t> time_in(JsonValue value);

struct DayAheadRow {
  std::int64_t utc_s = 0;
  double eur_per_mwh = 0;            ///< NaN = none
  int resolution_min = 0;            ///< 0: not said
  std::int64_t published_utc_s = 0;  ///< 0: not said
};

/// Paths of names. `rows` leads to a list of objects, each with time and price; with an empty one
/// `time` and `price` lead to two lists of one length, as energy-charts has them.
struct DayAheadFields {
  std::string_view rows = "";
  std::string_view time = "unix_seconds";
  std::string_view price = "price";
};

struct DayAheadAnswer {
  std::vector<DayAheadRow> rows{};  ///< in the answer's order, with and without a price
  int passed_over = 0;              ///< rows without a time
  std::string trouble{};            ///< why it is no such answer; then there are no rows
};

/// What is not a number (null, NaN, text) is no price. "unit" must be EUR/MWh where it is there.
DayAheadAnswer parse_day_ahead_json(std::string_view text, const DayAheadFields& fields = {});

/// -999 and the like: what instruments write for "no price"; nobody bids so.
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
  std::vector<DayAheadQuarterHour> quarter_hours{};  ///< those with a price, in order of time
  int resolution_min = 0;  ///< the longest of its rows; 60 also where each hour has one price
  /// One price through half a day or more: not an auction's result, but zeros until there is one.
  [[nodiscard]] bool is_constant() const;
};

struct DayAheadLayout {
  std::vector<DayAheadDay> days{};  ///< in order of time
  std::string trouble{};            ///< a time that is no quarter-hour; then there are no days
  /// The first time with two prices, of which the later row's counts; 0 = none.
  std::int64_t contradiction_utc_s = 0;
  double contradicting_eur_per_mwh[2] = {};
};

/// Rows in any order. Needs the market's time zone.
DayAheadLayout lay_out_day_ahead(std::vector<DayAheadRow> rows);

}  // namespace bess
