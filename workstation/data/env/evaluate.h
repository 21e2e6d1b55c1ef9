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
#include <span>
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
  double charge_value_eur = 0;  ///< part of the profit: value of the final charge
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

// Final charge as money. With the SoC carried over, a policy starts with the initial SoC and ends
// with any. The difference is sold or bought back at the mean settled price of the counted days,
// with losses, costs and wear, so that ending empty gives no advantage.
//
// Foresight also runs the days between the counted ones and may enter counted days charged. For it
// the changes over all counted days are summed, which for every other policy equals the last SoC
// minus the initial one.
//
// Not used with the day reset: there the final charge of each day is not valued, which favours the
// policy.

/// Mean over the steps of `days`, which must not be empty.
double mean_settled_eur_per_mwh(const MarketSteps& market, const std::vector<MarketDay>& days);

/// Adds the value of the final charge (negative if below the initial SoC) to the last day of
/// `carried_over`: profit, throughput and charge_value_eur. May be called once; no effect without
/// days.
void value_charge_left(Evaluation& carried_over, const BatteryParameters& battery,
                       double price_eur_per_mwh);

/// Evaluates `days`, which must not be empty, with the SoC carried over; values the final charge.
Evaluation evaluate_carried_over(const MarketSteps& market, const std::vector<MarketDay>& days,
                                 Policy& policy, const BatteryParameters& battery,
                                 double initial_soc_frac,
                                 std::vector<StepRecord>* records = nullptr);

// Drawdown of a policy's daily results: the largest fall of the cumulative profit from the end of
// one day to that of a later one, starting at 0; not within a day.

/// EUR per MWh of capacity, by day.
std::vector<double> daily_profits(const Evaluation& evaluation);

/// Running sum.
std::vector<double> cumulative(std::span<const double> days);
/// Each sum minus the highest so far, the initial 0 included: not positive.
std::vector<double> below_peak(std::span<const double> cumulative);
/// Largest fall, not negative.
double drawdown(std::span<const double> days);

}  // namespace bess
