#include "workstation/data/env/final_charge.h"

#include <cmath>
#include <stdexcept>

#include "shared/battery_model.h"
#include "shared/units_and_limits.h"

namespace bess {

double mean_settled_eur_per_mwh(const MarketSteps& market, const std::vector<MarketDay>& days) {
  double sum = 0;
  std::size_t steps = 0;
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) sum += step.paid_eur_per_mwh;
    steps += day.step_count;
  }
  return sum / static_cast<double>(steps);
}

void value_charge_left(Evaluation& carried_over, const BatteryParameters& battery,
                       double price_eur_per_mwh) {
  if (carried_over.values_charge_left()) throw std::logic_error("final charge already valued");
  if (carried_over.days.empty()) return;
  double gained_frac = 0;
  for (const DayResult& day : carried_over.days)
    gained_frac += day.soc_end_frac - day.soc_start_frac;
  const double stored_mwh = gained_frac * battery.capacity_wh / kWattsPerMegawatt;
  const double exchanged_mwh = stored_mwh > 0 ? -stored_mwh * battery.discharge_efficiency
                                              : -stored_mwh / battery.charge_efficiency;
  DayResult& last = carried_over.days.back();
  last.charge_value_eur = -exchange_cost_eur(battery, exchanged_mwh, price_eur_per_mwh);
  last.profit_eur += last.charge_value_eur;
  last.throughput_mwh += std::fabs(exchanged_mwh);
  carried_over.charge_price_eur_per_mwh = price_eur_per_mwh;
}

Evaluation evaluate_carried_over(const MarketSteps& market, const std::vector<MarketDay>& days,
                                 Policy& policy, const BatteryParameters& battery,
                                 double initial_soc_frac, std::vector<StepRecord>* records) {
  Evaluation done = evaluate(market, days, policy, {battery, initial_soc_frac, true}, records);
  value_charge_left(done, battery, mean_settled_eur_per_mwh(market, days));
  return done;
}

}  // namespace bess
