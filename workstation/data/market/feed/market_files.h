// Market file reader by format and name: downloads in any mixture to rows, and settled
// quarter-hours for reconstruction.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/market/feed/market_rows.h"

namespace bess {

// Times of custom price files: dates in a configured order, with a UTC offset or by a configured
// clock. Ambiguous times are refused, naming the line.

enum class WallClock { kUtc, kLocal };

struct CustomTimeFormat {
  std::string date_format = "yyyy-mm-dd";
  std::optional<WallClock> clock{};  ///< for times without an offset
};

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

/// Elia's CSV or JSON, custom CSV, ENTSO-E's XML, minute files (to join an earlier import with more
/// rows, or to reconstruct minutes from its settled prices) and recorded days. `name` is used in
/// messages.
MarketRows parse_market_text(std::string_view text, std::string_view name,
                             const CustomCsvFormat& own = {});

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
