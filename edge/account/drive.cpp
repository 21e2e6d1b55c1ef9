#include "edge/account/drive.h"

#include "edge/control/policy.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

PricedCycle priced_cycle(const CycleRecord& record) {
  const std::int16_t context_class =
      record.context_class > 0
          ? record.context_class
          : student_context_class(local_minute_of(record.utc_s), context_centi_of(record));
  return {record.utc_s, record.price.price_centi_eur_per_mwh, context_class};
}

double eur_per_mwh(const PricedCycle& cycle) {
  return static_cast<double>(cycle.price_centi_eur_per_mwh) / kCentiPerEur;
}

BatteryStep full_step(const BatteryParameters& battery, double soc_frac, Action action) {
  return battery_step(battery, soc_frac, power_sign(action) * battery.power_w_max, kHoursPerStep);
}

double earned_eur(const BatteryStep& step, double price_eur_per_mwh) {
  return -step.power_w * kHoursPerStep / kWattsPerMegawatt * price_eur_per_mwh;
}

Action decide_undisturbed(const PricedCycle& cycle, double soc_frac,
                          const PriceThresholds& thresholds) {
  const std::int32_t price = cycle.price_centi_eur_per_mwh;
  if (price <= thresholds.low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
  if (price >= thresholds.high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
  const auto soc_e4 = static_cast<std::int32_t>(soc_frac * kSocFullE4 + 0.5);
  return decide_with_student(
      make_lattice_state(local_minute_of(cycle.utc_s), cycle.context_class, soc_e4, price));
}

}  // namespace bess
