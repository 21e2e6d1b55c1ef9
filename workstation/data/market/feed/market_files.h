// Market file reader by format and name: downloads in any mixture to rows, and settled
// quarter-hours for reconstruction.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/feed/market_join.h"
#include "workstation/data/market/feed/market_rows.h"

namespace bess {

// Times of custom price files: dates in a configured order, with a UTC offset or by a configured
// clock. Ambiguous times are refused, naming the line.

enum class WallClock { kUtc, kLocal };

struct CustomTimeFormat {
  std::string date_format = "yyyy-mm-dd";
  std::optional<WallClock> clock{};  ///< for times without an offset
};

/// A line or part of one, with its number.
struct TextLine {
  std::size_t number;
  std::string_view text;
};

/// UTC instants, one for each text. In a repeated local hour (autumn) the order of the rows
/// decides. Throws UserError.
std::vector<std::int64_t> read_times(const std::vector<TextLine>& texts, std::string_view name,
                                     const CustomTimeFormat& form);

/// Seconds between prices, 60 or 900, by the majority of neighbours. Throws UserError for others.
std::int64_t step_of_times(std::vector<std::int64_t> utc_s, std::string_view name);

// JSON downloads: the API's records (`results`), exports (a bare array) and version 1
// (`records[].fields`).

/// `name` is used in messages.
MarketRows parse_market_json(std::string_view text, std::string_view name);

// ENTSO-E A85: settled imbalance prices of other single-price countries (entsoe.cpp).

bool looks_like_xml(std::string_view text);

/// Quarter-hours in order of time. Those with two different prices get none and are counted in
/// `dual_priced_quarter_hours`. `name` is used in messages. Throws UserError.
MarketRows parse_entsoe_xml(std::string_view text, std::string_view name);

// CSV: downloads and custom files, `;` `,` or tabs, optional quotes, any column order.

/// Format of a custom file: column names, empty for detection.
struct CustomCsvFormat {
  std::string time_column, price_column;
  CustomTimeFormat times;
};

/// Without a resolution code the spacing of the rows decides between minutes and quarter-hours, and
/// contradictions of one time are an error. `name` is used in messages.
MarketRows parse_market_csv(std::string_view text, std::string_view name,
                            const CustomCsvFormat& own = {});

// Prices in any supported form, detected by content.

/// Elia's CSV or JSON, custom CSV, ENTSO-E's XML, minute files and recorded days. `name` is used in
/// messages.
MarketRows parse_market_text(std::string_view text, std::string_view name,
                             const CustomCsvFormat& own = {});

// Minute files as rows, to join an earlier import with more rows or to reconstruct minutes from its
// settled prices.

/// Indicative prices as minutes, settled ones as quarter-hours; the sources are those named in its
/// comments.
MarketRows parse_minute_file_rows(std::string_view text, std::string_view name);
/// Whether a spreadsheet saved a minute file with semicolons, and that file with commas and decimal
/// points, row by row.
bool is_spreadsheet_minute_csv(std::string_view text);
std::string from_spreadsheet(std::string_view text);

/// Rows of all files in order; `own` is the format of custom CSV.
MarketRows read_market_files(const std::vector<std::string>& paths,
                             const CustomCsvFormat& own = {});

struct SettledQuarterHours {
  std::vector<QuarterHour> quarter_hours;  ///< ascending
  std::set<MarketSource> sources;
  JoinReport report;
  std::size_t minutes_unused = 0;  ///< minute rows of the files
};

/// Settled quarter-hours of the files; those of a minute file have no system imbalance. Throws
/// UserError if there are none.
SettledQuarterHours read_quarter_hour_files(const std::vector<std::string>& paths);

/// File names without folders, for the provenance.
std::string file_names(const std::vector<std::string>& paths);

/// One line with the sources, as the licences require.
std::string attribution_of(const std::set<MarketSource>& sources);

}  // namespace bess
