// Join of unordered rows into one minute series: sorts, drops duplicates, joins the minutes with
// their settled quarter-hours, and reports the result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/data/market/feed/market_rows.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

// Joined minute files must agree where they overlap, because both claim to be the market. Downloads
// differ: a later one corrects an earlier one.

class Overlap {
 public:
  /// Compares the rows of a minute file with those of the previous files.
  void add(const std::string& name, const MarketRows& rows);
  /// One error if any two disagree, otherwise none.
  [[nodiscard]] std::vector<Finding> findings() const;

 private:
  struct Price {
    double eur_per_mwh;
    std::size_t file;  ///< index into names_
  };
  using Prices = std::unordered_map<std::int64_t, Price>;
  void add_price(Prices& known, const char* column, std::int64_t utc_s, double eur_per_mwh);

  std::vector<std::string> names_;
  Prices minutes_, quarter_hours_;
  std::size_t disagreements_ = 0;
  Finding first_{};
};

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

/// Throws UserError if the rows are too far apart for a dense series.
void check_span(std::int64_t from_utc_s, std::int64_t until_utc_s, std::string_view name);

/// One line for each kind of row without a price; empty if there is none.
std::string describe_dual_priced(const JoinReport& report);

/// Text for the user: joined and missing data.
std::string describe_join(const JoinedMarket& market);

}  // namespace bess
