// Market file reader by format and name: downloads in any mixture to rows, and settled
// quarter-hours for reconstruction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/user_error.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

// Rows of downloaded market files in any form: Elia's CSV and JSON exports of ods046, ods047,
// ods133, ods134, ods161 and ods162 under API field names or portal labels, tidy CSV, and the
// minute files of this program. Names are compared without case, spaces and punctuation, so
// "Marginal incremental price" equals "marginalincrementalprice".
// Quality flags are ignored: according to Elia DataIssue is set on far too many usable rows.

/// Text that stands for a missing value: "", null, NaN, NA and the like.
bool is_absent(std::string_view text);

/// Indicative price computed at the END of the minute that starts at `utc_s`.
struct MinuteRow {
  std::int64_t utc_s;
  double indicative_eur_per_mwh;  ///< NaN = the TSO published the row without a price
};

/// Prices of the two parties to an imbalance.
struct PartyPrices {
  double long_eur_per_mwh = kNotPublished, short_eur_per_mwh = kNotPublished;

  [[nodiscard]] bool are_different() const {
    return is_published(long_eur_per_mwh) && is_published(short_eur_per_mwh) &&
           long_eur_per_mwh != short_eur_per_mwh;
  }
  /// The common price; NaN if there are two different ones, or none.
  [[nodiscard]] double single() const {
    if (are_different()) return kNotPublished;
    return is_published(long_eur_per_mwh) ? long_eur_per_mwh : short_eur_per_mwh;
  }
};

enum class MarketSource {
  kElia,
  kEntsoe,
  kSimulated,  ///< minute file of `prices simulate`
  kDrawn,      ///< minute file with minutes of `prices reconstruct`
  kUnknown,    ///< tidy files do not state their source
};

/// Readable data of another dataset.
struct NotMarketData : UserError {
  using UserError::UserError;
};

/// In the order of the files; join_market() handles duplicates and disorder.
struct MarketRows {
  std::vector<MinuteRow> minutes;
  std::vector<QuarterHour> quarter_hours;
  /// Times of the rows that lost their price because it was not unique.
  std::set<std::int64_t> dual_priced_minutes{}, dual_priced_quarter_hours{};
  std::set<MarketSource> sources{};
  std::string zone{};               ///< EIC of the area; empty: unknown
  bool is_minute_file = false;      ///< written by this program: overlaps must agree
  std::vector<Finding> findings{};  ///< contradictions between files
};

/// Throws UserError for rows of another zone.
void append_rows(MarketRows& all, const MarketRows& rows);

enum class MarketField {
  kTime,
  kResolution,
  kQuarterHour,  ///< minute rows only
  kSystemImbalance,
  kAlpha,
  kMarginalIncremental,
  kMarginalDecremental,
  kPrice,
  kPositivePrice,  ///< long party; until May 2024 there are two prices
  kNegativePrice,  ///< short party
};
inline constexpr std::size_t kMarketFieldCount = 10;

/// A name without case, spaces and punctuation.
std::string plain_name(std::string_view label);

/// Field of a column label or JSON key; nothing for unused ones.
std::optional<MarketField> market_field_of(std::string_view label);
/// Whether custom files may use this name for the time or the price, with any unit.
bool may_be_called(std::string_view label, MarketField field);

/// Collects the fields of one row and adds it as a minute or a quarter-hour. Throws UserError.
class MarketRowBuilder {
 public:
  /// `place` names the row in messages, e.g. "prices.csv:17"; it must outlive the builder.
  /// `has_decimal_commas`: "-30,258" is a number, as with semicolons as separators.
  explicit MarketRowBuilder(std::string_view place, bool has_decimal_commas = false)
      : place_(place), has_decimal_commas_(has_decimal_commas) {
    numbers_.fill(kNotPublished);
  }

  void set_text(MarketField field, std::string_view text);
  void set_number(MarketField field, double value);
  void set_time(std::int64_t utc_s) { utc_s_ = utc_s; }
  void set_minute() { has_quarter_hour_ = true; }
  void finish(MarketRows& rows) const;

 private:
  [[nodiscard]] bool is_minute() const;

  std::string_view place_;
  std::array<double, kMarketFieldCount> numbers_{};  ///< by MarketField
  std::optional<std::int64_t> utc_s_;
  std::string_view resolution_;
  bool has_quarter_hour_ = false;
  bool has_decimal_commas_;
};

// Join of unordered rows into one minute series: sorts, drops duplicates, joins the minutes with
// their settled quarter-hours, and reports the result.

struct JoinReport {
  std::size_t minutes = 0, quarter_hours = 0;  ///< after dropping duplicates
  std::size_t duplicates = 0;
  std::size_t duplicates_changed = 0;  ///< with another price; the last row read is kept
  std::size_t dual_priced_minutes = 0, dual_priced_quarter_hours = 0;  ///< two prices: omitted
  std::vector<Finding> findings{};    ///< contradicting minute files
  bool settled_from_minutes = false;  ///< no quarter-hours: minute 14 replaces them
};

struct JoinedMarket {
  MinuteSeries series;
  JoinReport report;
};

/// Throws UserError without rows, or without any price. `name` is used in messages.
JoinedMarket join_market(MarketRows rows, std::string_view name);

/// Ascending, one per time. The last duplicate read is kept, but never a row without a price over
/// one with a price.
std::vector<QuarterHour> sorted_quarter_hours(std::vector<QuarterHour> rows, JoinReport& report);

/// One line for each kind of row without a price; empty if there is none.
std::string describe_dual_priced(const JoinReport& report);

/// Text for the user: joined and missing data.
std::string describe_join(const JoinedMarket& market);

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
