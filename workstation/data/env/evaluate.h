// Policy evaluation over market days [SPEC 3, 4]. Day reset: every day starts at the initial SoC
// and its end is free. Carried over: each day of the split starts at the final SoC of the one
// before, the first at the initial SoC. Chained days are not adjacent in time (26 to 31 January,
// then 26 February). A policy without look-ahead is unaffected, but foresight would arrange its SoC
// for a price jump that no market made. With the SoC carried over, foresight therefore plans and
// runs the whole series, and the split's days are summed: their part of the best run of the whole
// period. (939.9 on the benchmark; one plan over the chained days would give 954.)
//
// Profit is net of trading costs and wear (shared/battery_model.h). A step is paid at the mean
// price of its two minutes, and a percentage applies to that mean: where a quarter-hour ends inside
// a step and the price changes its sign, a settlement by quarter-hours deducts slightly more. After
// cycles_per_day_max of a local day no order is given until midnight; before that, a direction is
// kept for minimum_run_min. Capacity fades with the steps that are run; profits refer to the
// purchased capacity.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/policy.h"

namespace bess {

struct EvaluationOptions {
  BatteryParameters battery;
  double initial_soc_frac = 0.5;
  bool carry_soc = false;
};

struct DayResult {
  std::string date;
  double profit_eur;
  double cycles;  ///< equivalent full cycles: throughput / 2C
  int switches;   ///< changes of the action
  double soc_end_frac;
  double throughput_mwh = 0;  ///< charged and discharged, grid side
  double soc_start_frac = 0;
  double charge_value_eur = 0;  ///< part of the profit: final charge (final_charge.h)
};

/// Final charge as a part of the profit, EUR per day per MWh of capacity; NaN if not valued.
struct ChargeLeft {
  double price_eur_per_mwh;
  double value_eur_per_day_per_mwh;
};

struct Evaluation {
  std::vector<DayResult> days;
  double capacity_mwh = 0;
  double wear_eur_per_mwh = 0;  ///< deducted from the profits
  /// Price of the final charge in the last day's profit; NaN: not valued.
  double charge_price_eur_per_mwh = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool values_charge_left() const { return !std::isnan(charge_price_eur_per_mwh); }
  [[nodiscard]] ChargeLeft charge_left() const;
  [[nodiscard]] double profit_eur_per_day_per_mwh() const;
  /// Profit of the same decisions with another wear cost.
  [[nodiscard]] double profit_at_wear_eur_per_day_per_mwh(double other_wear_eur_per_mwh) const;
  [[nodiscard]] DayErrors errors() const;  ///< of the mean over days, same unit
  [[nodiscard]] double worst_day_eur_per_mwh() const;
  [[nodiscard]] double cycles_per_day() const;
  [[nodiscard]] double switches_per_day() const;
  [[nodiscard]] double soc_end_mean() const;
};

/// One decided step, for records and figures.
struct StepRecord {
  std::int64_t utc_s;
  double observed_eur_per_mwh;
  double paid_eur_per_mwh;
  double level_eur_per_mwh;  ///< trailing price level
  double soc_frac;           ///< before the step
  Action action;
  double power_w;  ///< exchanged, charge positive
  double profit_eur;
};

/// Evaluates `policy` on `days` of `market`; appends every step to `records` if given.
Evaluation evaluate(const MarketSteps& market, const std::vector<MarketDay>& days, Policy& policy,
                    const EvaluationOptions& options, std::vector<StepRecord>* records = nullptr);

/// Mean and standard errors of the daily difference a - b, EUR per day per MWh, on the same days.
struct PairedDifference {
  double mean;
  DayErrors errors{};
};
/// Throws std::logic_error unless both have the same days.
PairedDifference paired_difference(const Evaluation& a, const Evaluation& b);

}  // namespace bess
