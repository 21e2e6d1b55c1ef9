// Prices of a scenario: the minute series of the market, the rows available to the edge at an
// instant, for the judge, and day-ahead prices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// Minutes from four days before the start to the end; unpublished rows have no price. Throws
/// UserError if the scenario's file does not contain its time.
MinuteSeries scenario_prices(const Scenario& scenario);

/// File of the scenario; else synthetic prices from the local day before the start to two days
/// after the end, with a morning, noon and evening pattern, a level by date, and distinct
/// quarter-hours.
std::string day_ahead_csv(const Scenario& scenario);
std::vector<AuctionRow> day_ahead_rows(const Scenario& scenario);

class Publication {
 public:
  struct Row {
    std::int64_t minute_utc_s = 0;
    double eur_per_mwh = 0;
  };

  Publication(const Scenario& scenario, const MinuteSeries& prices);

  /// Newest row with a price available to the edge by then, with faults of the server.
  [[nodiscard]] std::optional<Row> newest(std::int64_t utc_ns) const;
  /// Published price of a minute; empty: none.
  [[nodiscard]] std::optional<double> price_of(std::int64_t minute_utc_s) const;

 private:
  [[nodiscard]] std::optional<Row> newest_published(std::int64_t utc_ns, int skip) const;
  /// Price of this minute on the server; NaN: none.
  [[nodiscard]] double shown(std::int64_t minute) const;

  const Scenario& scenario_;
  const MinuteSeries& prices_;
  std::vector<MinuteSpan> silent_;  ///< no new rows from the server
};

}  // namespace bess
