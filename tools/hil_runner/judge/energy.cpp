#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_energy(Bench& bench) {
  const BatteryParameters& p = bench.scenario.battery.physics;
  double stored_wh = 0;
  double moved_wh = 0;
  double unknown_wh = 0.5;
  double before_wh = 0;
  const double lost_wh_max = p.full_power_loss_frac * p.power_w_max / 60;  // of a minute
  for (const MinuteRecord& m : bench.evidence.minutes) {
    const double flow_wh = m.energy_wh - p.standby_w / 60;
    // Of a minute that was charged and discharged in, the record knows the sum; the slowest battery
    // that is simulated turns 5 s after its order. Nor does it know the squares of what changed.
    if (flow_wh * before_wh < 0) {
      unknown_wh += p.power_w_max * (6 + bench.evidence.slack_s) / 3'600 *
                    (1 / p.discharge_efficiency - p.charge_efficiency);
    }
    if (std::abs(flow_wh - before_wh) > 0.01 * p.power_w_max / 60) unknown_wh += lost_wh_max;
    before_wh = flow_wh;
    stored_wh += stored_power_w(p, 60 * flow_wh) / 60;
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
