// The prices of a scenario: the minute file that the market serves, and the truth about what the
// edge can know of it at an instant, by which its orders are judged.
#pragma once

#include <cstdint>
#include <optional>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// Minutes from four days before the start to the end, rows that are never published without a
/// price. Throws UserError when the scenario's own file does not hold its time.
MinuteSeries scenario_prices(const Scenario& scenario);

class Publication {
 public:
  struct Row {
    std::int64_t minute_utc_s = 0;
    double eur_per_mwh = 0;
  };

  Publication(const Scenario& scenario, const MinuteSeries& prices);

  /// The newest row with a price that an edge can have fetched by then, faults of the server
  /// counted.
  [[nodiscard]] std::optional<Row> newest(std::int64_t utc_ns) const;
  /// Of a minute; nothing where none was published.
  [[nodiscard]] std::optional<double> price_of(std::int64_t minute_utc_s) const;

 private:
  [[nodiscard]] std::optional<Row> newest_published(std::int64_t utc_ns, int skip) const;
  /// What the server has as the price of this minute of the series; not a number: none.
  [[nodiscard]] double shown(std::int64_t minute) const;

  const Scenario& scenario_;
  const MinuteSeries& prices_;
  std::vector<MinuteSpan> silent_;  ///< the server gives nothing new
};

}  // namespace bess
