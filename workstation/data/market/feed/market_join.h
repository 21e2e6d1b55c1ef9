// From rows in any order to one minute series: sorts, drops duplicates, joins the minutes with
// their settled quarter-hours, and says what it did.
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

// Minute files that are joined must agree where they overlap: both claim to be the market.
// Downloads are another matter, a later one corrects an earlier one.

class Overlap {
 public:
  /// Compares the rows of a minute file with those of the files before it.
  void add(const std::string& name, const MarketRows& rows);
  /// One error when any two disagree, otherwise none.
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
  std::size_t duplicates_changed = 0;  ///< with another price: the row read last is kept
  std::size_t dual_priced_minutes = 0, dual_priced_quarter_hours = 0;  ///< two prices: left out
  std::vector<Finding> findings{};    ///< of the rows: minute files that contradict each other
  bool settled_from_minutes = false;  ///< no quarter-hours were given: minute 14 stands for them
};

struct JoinedMarket {
  MinuteSeries series;
  JoinReport report;
};

/// Throws UserError when there are no rows, or none with a price. `name` is used in messages.
JoinedMarket join_market(MarketRows rows, std::string_view name);

/// Ascending, one per time. Of duplicates the last one read wins, but never a row without a price
/// over one with a price.
std::vector<QuarterHour> sorted_quarter_hours(std::vector<QuarterHour> rows, JoinReport& report);

/// Throws UserError when rows are so far apart that a dense series of them cannot be meant.
void check_span(std::int64_t from_utc_s, std::int64_t until_utc_s, std::string_view name);

/// A line for each kind of row that lost its price; empty when none did.
std::string describe_dual_priced(const JoinReport& report);

/// Lines that tell a user what was joined and what is missing.
std::string describe_join(const JoinedMarket& market);

}  // namespace bess
