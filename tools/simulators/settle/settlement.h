// What a closed-loop run earned, counted twice: from the battery's own record of energy, minute by
// minute, and from the edge's log of what it read and ordered. The two never share a number, so
// their difference is the error of the whole loop: latency, rounding of SoC, and orders that were
// not carried out.
#pragma once

#include <vector>

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

/// Wall time of the edge's cycles, microseconds.
struct Latency {
  double median_us = 0;
  double p99_us = 0;
  double max_us = 0;
};

struct RunSettlement {
  Account battery;  ///< from the battery's record
  Account edge;  ///< from the edge's log: each order through the battery model from the SoC it read
  std::size_t cycles = 0;
  std::size_t cycles_running = 0;
  Latency decision, write, total;
};

/// Only minutes from the edge's first to the end of its last cycle count. Throws UserError when a
/// minute has no settled price.
RunSettlement settle(const CsvTable& battery_record, const CsvTable& edge_log,
                     const MinuteSeries& prices, const BatteryParameters& battery);

}  // namespace bess
