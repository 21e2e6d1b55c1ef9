// Runs a policy over days of the market and counts its money [SPEC 3, 4].
// Day reset: every day starts at the initial SoC and ends free. Carried over: the days of the split
// are chained, each starts where the one before it ended and only the first starts at the initial
// SoC. Chained days are not neighbours in time (26 to 31 January, then 26 February), which a policy
// that cannot see ahead never notices; perfect foresight would arrange its SoC for a price jump
// that no market ever made. So with the SoC carried over it plans and runs the whole series, all
// days of the file, and the split's days are summed: what they bring to the best run of the whole
// period. (On the yardstick 939.9; one plan over the chained days would claim 954.)
//
// Profit is net of trading costs and wear (shared/exchange_cost.h). A step is paid at the mean
// price of its two minutes, and a percentage is taken of that mean: where a quarter-hour ends
// inside a step and the price changes its sign, a bill by quarter-hours takes a little more. Once a
// local day has used up cycles_per_day_max no further order is given until midnight, whatever the
// policy says; before that, a direction is kept for minimum_run_min. Capacity that fades is that of
// the steps that are run, and a profit stays one by the capacity that was bought.
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
  double cycles;  ///< equivalent full cycles: energy through / 2C
  int switches;   ///< changes of the action
  double soc_end_frac;
  double throughput_mwh = 0;  ///< charged and discharged, grid side
  double soc_start_frac = 0;
  double charge_value_eur = 0;  ///< part of the profit: the charge left at the end (charge_left.h)
};

/// The charge left at the end as a part of the profit, EUR per day per MWh of capacity; NaN where
/// it is not valued.
struct ChargeLeft {
  double price_eur_per_mwh;
  double value_eur_per_day_per_mwh;
};

struct Evaluation {
  std::vector<DayResult> days;
  double capacity_mwh = 0;
  double wear_eur_per_mwh = 0;  ///< that the profits are net of
  /// At which the charge left at the end is valued in the last day's profit; NaN: it is not.
  double charge_price_eur_per_mwh = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool values_charge_left() const { return !std::isnan(charge_price_eur_per_mwh); }
  [[nodiscard]] ChargeLeft charge_left() const;
  [[nodiscard]] double profit_eur_per_day_per_mwh() const;
  /// Of the same decisions, with this wear in place of the one that is counted.
  [[nodiscard]] double profit_at_wear_eur_per_day_per_mwh(double other_wear_eur_per_mwh) const;
  [[nodiscard]] DayErrors errors() const;       ///< of the mean over days, same unit
  [[nodiscard]] double standard_error() const;  ///< the plain one; NaN for one day
  [[nodiscard]] double worst_day_eur_per_mwh() const;
  [[nodiscard]] double cycles_per_day() const;
  [[nodiscard]] double switches_per_day() const;
  [[nodiscard]] double soc_end_mean() const;
};

/// One decided step, for records and pictures.
struct StepRecord {
  std::int64_t utc_s;
  double observed_eur_per_mwh;
  double paid_eur_per_mwh;
  double level_eur_per_mwh;  ///< trailing price level
  double soc_frac;           ///< before the step
  Action action;
  double power_w;  ///< really exchanged, charge positive
  double profit_eur;
};

/// Evaluates `policy` on `days` of `market`. Appends every step to `records` when it is given.
Evaluation evaluate(const MarketSteps& market, const std::vector<MarketDay>& days, Policy& policy,
                    const EvaluationOptions& options, std::vector<StepRecord>* records = nullptr);

/// Mean and standard errors of the day-by-day difference a - b, EUR per day per MWh. Same days
/// required.
struct PairedDifference {
  double mean;
  double standard_error;  ///< as if days were independent; NaN of one day
  double standard_error_by_month = std::numeric_limits<double>::quiet_NaN();  ///< NaN of one month
  int months = 0;
  int days = 0;

  [[nodiscard]] DayErrors errors() const {
    return {standard_error, standard_error_by_month, months, days};
  }
};
PairedDifference paired_difference(const Evaluation& a, const Evaluation& b);

}  // namespace bess
