#include "edge/account/drive.h"

#include "edge/control/policy.h"
#include "shared/exchange_cost.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

PricedCycle priced_cycle(const CycleRecord& record, const QuarterPrices& prices) {
  const double decided_eur_per_mwh =
      static_cast<double>(record.price.price_centi_eur_per_mwh) / kCentiPerEur;
  return {
      record.utc_s, decided_price_centi(record),
      static_cast<float>(prices.of_step_eur_per_mwh(record.utc_s).value_or(decided_eur_per_mwh)),
      context_class_now(record)};
}

BatteryStep full_step(const BatteryParameters& battery, double soc_frac, Action action) {
  return battery_step(battery, soc_frac, power_sign(action) * battery.power_w_max, kHoursPerStep);
}

double earned_eur(const BatteryParameters& battery, const BatteryStep& step,
                  double price_eur_per_mwh) {
  return -exchange_cost_eur(battery, step.power_w * kHoursPerStep / kWattsPerMegawatt,
                            price_eur_per_mwh);
}

double stored_worth_eur(const BatteryParameters& battery, double more_frac,
                        double price_eur_per_mwh) {
  const double stored_mwh = more_frac * battery.capacity_wh / kWattsPerMegawatt;
  const double exchanged_mwh = stored_mwh > 0 ? -stored_mwh * battery.discharge_efficiency
                                              : -stored_mwh / battery.charge_efficiency;
  return -exchange_cost_eur(battery, exchanged_mwh, price_eur_per_mwh);
}

Action decide_undisturbed(const PricedCycle& cycle, double soc_frac,
                          const PriceThresholds& thresholds) {
  const std::int32_t price = cycle.price_centi_eur_per_mwh;
  if (price <= thresholds.low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
  if (price >= thresholds.high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
  const auto soc_e4 = static_cast<std::int32_t>(soc_frac * kSocFullE4 + 0.5);
  const LocalMinute now = local_minute_of(cycle.utc_s);
  const LatticeState state = make_lattice_state(now, cycle.context_class, soc_e4, price);
  return nearest_allowed(student_rule_limits(now, state, price).actions,
                         decide_with_student(state));
}

}  // namespace bess
