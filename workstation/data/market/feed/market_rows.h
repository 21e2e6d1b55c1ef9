// Rows of downloaded market files, whatever their form: Elia's CSV and JSON exports of ods046,
// ods047, ods133, ods134, ods161 and ods162, under API field names or portal labels, tidy CSV, and
// the minute files that this program writes.
// Names are compared without case, spaces and punctuation, so "Marginal incremental price" and
// "marginalincrementalprice" are one.
// No row is refused for its quality flag: Elia says itself that DataIssue is set on far too many
// usable rows.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/user_error.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

/// Indicative price computed at the END of the minute that starts at `utc_s`.
struct MinuteRow {
  std::int64_t utc_s;
  double indicative_eur_per_mwh;  ///< NaN = the TSO published the row without a price
};

enum class MarketSource {
  kElia,
  kEntsoe,
  kSimulated,  ///< of a minute file: by `prices simulate`
  kDrawn,      ///< of a minute file: its minutes are by `prices reconstruct`
  kUnknown,    ///< tidy files do not say where they come from
};

/// Read without trouble, and not what is looked for: another dataset.
struct NotMarketData : UserError {
  using UserError::UserError;
};

/// In the order of the files; duplicates and disorder are the business of join_market().
struct MarketRows {
  std::vector<MinuteRow> minutes;
  std::vector<QuarterHour> quarter_hours;
  /// Times of the rows that lost their price because it was not one.
  std::set<std::int64_t> dual_priced_minutes{}, dual_priced_quarter_hours{};
  std::set<MarketSource> sources{};
  bool is_minute_file = false;      ///< one that this program wrote: its overlaps must agree
  std::vector<Finding> findings{};  ///< about how the files agree
};

void append_rows(MarketRows& all, const MarketRows& rows);

enum class MarketField {
  kTime,
  kResolution,
  kQuarterHour,  ///< only minute rows have one
  kSystemImbalance,
  kAlpha,
  kMarginalIncremental,
  kMarginalDecremental,
  kPrice,
  kPositivePrice,  ///< of a long party; the datasets until May 2024 have the two instead of one
  kNegativePrice,  ///< of a short party
};

/// A name without case, spaces and punctuation.
std::string plain_name(std::string_view label);

/// Field of a column label or JSON key; nothing for those that are not needed.
std::optional<MarketField> market_field_of(std::string_view label);
/// True of a name by which somebody may call the time or the price, whatever the unit behind it.
bool may_be_called(std::string_view label, MarketField field);

/// Collects the fields of one row and files it as a minute or a quarter-hour. Throws UserError.
class MarketRowBuilder {
 public:
  /// `place` names the row in messages, e.g. "prices.csv:17"; it must outlive the builder.
  /// `has_decimal_commas`: "-30,258" is a number, as where semicolons separate the fields.
  explicit MarketRowBuilder(std::string_view place, bool has_decimal_commas = false)
      : place_(place), has_decimal_commas_(has_decimal_commas) {}

  void set_text(MarketField field, std::string_view text);
  void set_number(MarketField field, double value);
  void set_time(std::int64_t utc_s) { utc_s_ = utc_s; }
  void set_minute() { has_quarter_hour_ = true; }
  void finish(MarketRows& rows) const;

 private:
  [[nodiscard]] bool is_minute() const;
  [[nodiscard]] bool is_dual_priced() const;
  [[nodiscard]] double single_price() const;

  std::string_view place_;
  QuarterHour values_;
  double positive_eur_per_mwh_ = kNotPublished, negative_eur_per_mwh_ = kNotPublished;
  std::optional<std::int64_t> utc_s_;
  std::string_view resolution_;
  bool has_quarter_hour_ = false;
  bool has_decimal_commas_;
};

}  // namespace bess
