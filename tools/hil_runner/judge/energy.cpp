#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_energy(Bench& bench) {
  const BatteryParameters& p = bench.scenario.battery.physics;
  double stored_wh = 0;
  double moved_wh = 0;
  double unknown_wh = 0.5;
  double before_wh = 0;
  for (const MinuteRecord& m : bench.evidence.minutes) {
    // Of a minute that was charged and discharged in, the record knows the sum; the slowest battery
    // that is simulated turns 5 s after its order.
    if (m.energy_wh * before_wh < 0) {
      unknown_wh += p.power_w_max * (6 + bench.evidence.slack_s) / 3'600 *
                    (1 / p.discharge_efficiency - p.charge_efficiency);
    }
    before_wh = m.energy_wh;
    stored_wh +=
        m.energy_wh > 0 ? m.energy_wh * p.charge_efficiency : m.energy_wh / p.discharge_efficiency;
    moved_wh += std::abs(m.energy_wh);
  }
  if (bench.evidence.minutes.empty()) return;
  const MinuteRecord& last = bench.evidence.minutes.back();
  const double by_soc_wh = (last.soc_frac - bench.scenario.battery.soc_frac) * p.capacity_wh;
  if (std::abs(stored_wh - by_soc_wh) <= 0.001 * moved_wh + unknown_wh) return;
  bench.find((last.minute_utc_s + 60) * kSecondNs,
             fmt::format("{:.1f} Wh stored, by the energy", stored_wh),
             fmt::format("{:.1f} Wh by the SoC", by_soc_wh));
}

}  // namespace bess
