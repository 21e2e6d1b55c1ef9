// Market files by format and name: downloads in any mixture to rows, and settled quarter-hours for
// reconstruction.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/feed/market_join.h"
#include "workstation/data/market/feed/market_rows.h"

namespace bess {

// Times of price files that are nobody's download: dates in a named order, with their UTC offset or
// by a named clock. Nothing is guessed: what could be two instants is refused, naming the line.

enum class WallClock { kUtc, kLocal };

struct OwnTimes {
  std::string date_format = "yyyy-mm-dd";
  std::optional<WallClock> clock{};  ///< of times without an offset
};

/// A line or a part of one, and the line's number.
struct TextLine {
  std::size_t number;
  std::string_view text;
};

/// The instants in UTC, one of each text. Of a local hour that comes twice, in autumn, the order of
/// the rows tells which is which. Throws UserError.
std::vector<std::int64_t> read_times(const std::vector<TextLine>& texts, std::string_view name,
                                     const OwnTimes& form);

/// Seconds between prices, 60 or 900: what most neighbours are apart. Throws UserError for others.
std::int64_t step_of_times(std::vector<std::int64_t> utc_s, std::string_view name);

// JSON downloads: the API's records (`results`), exports (a bare array) and version 1
// (`records[].fields`).

/// `name` is used in messages.
MarketRows parse_market_json(std::string_view text, std::string_view name);

// CSV: downloads and files of one's own, `;` `,` or tabs, optional quotes, any column order.

/// How a file of one's own is read: names of columns, empty where they are to be found.
struct OwnForm {
  std::string time_column, price_column;
  OwnTimes times;
};

/// Without a resolution code the rows are minutes or quarter-hours by how far apart they are, and
/// contradictions of one time are an error. `name` is used in messages.
MarketRows parse_market_csv(std::string_view text, std::string_view name, const OwnForm& own = {});

// Prices in any form that is read: told apart by content, parsed by the reader of that form.

/// Elia's CSV or JSON, CSV of one's own, ENTSO-E's XML, minute files and recorded days. `name` is
/// used in messages.
MarketRows parse_market_text(std::string_view text, std::string_view name, const OwnForm& own = {});

// Minute files as rows, so that what `prices import` wrote can be joined with more, or its settled
// prices be the ground of a reconstruction.

/// Indicative prices as minutes, settled ones as quarter-hours; its sources are those that its
/// comments name.
MarketRows parse_minute_file_rows(std::string_view text, std::string_view name);
/// True of a minute file that a spreadsheet saved with semicolons, and that file with commas and
/// decimal points again, row by row.
bool is_spreadsheet_minute_csv(std::string_view text);
std::string from_spreadsheet(std::string_view text);

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
