// Energy and money of a closed-loop run, from both ends of the loop: from the battery trace, and
// from the SoC and orders in the decision log. The two are independent, so their difference is the
// error of the loop: latency, rounding of SoC, and orders that were not followed.
#pragma once

#include "shared/battery_model.h"
#include "shared/host/csv.h"
#include "shared/host/minute_file.h"

namespace bess {

/// Sums over one side of the comparison. Energy is grid side.
struct Account {
  double charged_wh = 0;
  double discharged_wh = 0;
  double profit_eur = 0;
  double soc_end_frac = 0;

  /// Grid side, charge positive, at the settled price with the battery's costs.
  void add(const BatteryParameters& battery, double energy_wh, double settled_eur_per_mwh);
};

/// Wall time in the edge's control cycles, microseconds.
struct Latency {
  double median_us = 0;
  double p99_us = 0;
  double max_us = 0;
};

struct RunSettlement {
  Account battery;  ///< from the battery trace
  Account edge;     ///< from the decision log: battery model with each order and the SoC read
  std::size_t cycles = 0;
  std::size_t cycles_running = 0;
  Latency decision, write, total;
};

/// Period: first to last control cycle of the log. Throws UserError if a minute has no settled
/// price.
RunSettlement settle(const CsvTable& battery_record, const CsvTable& edge_log,
                     const MinuteSeries& prices, const BatteryParameters& battery);

}  // namespace bess
