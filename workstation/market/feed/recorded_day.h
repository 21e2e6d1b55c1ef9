// A day of recorded minutes as text: what `prices record` appends to and whatever takes prices
// reads.
//   minute_utc            the minute's start; the price is computed at its end
//   price_eur_mwh         indicative imbalance price (ods161); empty = published without one
//   system_imbalance_mw   of the minute (ods169), negative = Belgium is short
//   price_arrived_utc     when each of them was there for the first time; empty = not in this line
//   imbalance_arrived_utc
//   quality_status        Elia's, of the price
//   arrival               seen = the look before, a short time earlier, did not show it; found = it
//                         may have been there for long
// A line holds what arrived of a minute; further lines of the same minute add to it or revise it,
// so that nothing is ever overwritten. The reader takes the FIRST price of a minute: the one that
// could be acted on. The last column is never empty and of two words, which no cut makes of one
// another: a line that lost its end is known by it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/market/feed/market_rows.h"

namespace bess {

struct RecordedValue {
  double value;  ///< NaN = published without one
  std::int64_t arrived_utc_s;
};

struct RecordedLine {
  std::int64_t minute_utc_s = 0;
  std::optional<RecordedValue> price_eur_per_mwh, system_imbalance_mw;
  QualityStatus quality;  ///< of the price
  bool seen =
      false;  ///< the arrival is known; else it was earlier than written, by how much nobody knows
};

/// The head of a file: each line of `provenance` as a comment, and the names of the columns.
std::string recorded_head(std::string_view provenance);
std::string format_recorded_line(const RecordedLine& line);

/// True of a text with the columns of a recorded day.
bool is_recorded_csv(std::string_view text);

/// The part of a text that a crash or a power cut left whole, from its head on.
struct WholePart {
  std::string_view text;
  bool lacks_line_end;  ///< its last line is whole but for that
};
WholePart whole_part(std::string_view text);

/// The lines of the whole part. Throws UserError naming the line when one of them is not a recorded
/// one.
std::vector<RecordedLine> parse_recorded_day(std::string_view text, std::string_view name);

/// How long after its minute's end a price arrived.
struct Lateness {
  std::size_t seen = 0;   ///< prices whose arrival is known
  std::size_t found = 0;  ///< prices that were there when one looked: they count in neither figure
  double median_s = 0, p95_s = 0;  ///< of those seen
};

class LatenessTally {
 public:
  /// The first price of a minute.
  void add(std::int64_t minute_utc_s, std::int64_t arrived_utc_s, bool seen);
  [[nodiscard]] Lateness result() const;

 private:
  std::vector<std::int32_t> late_s_;
  std::size_t found_ = 0;
};

Lateness lateness_of(const std::vector<RecordedLine>& lines);
/// One line for people.
std::string describe_lateness(const Lateness& lateness);

/// As minutes; of a minute that was revised, the first price.
MarketRows parse_recorded_rows(std::string_view text, std::string_view name);

}  // namespace bess
