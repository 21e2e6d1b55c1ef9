#include "tools/hil_runner/judge/bench.h"

#include <cmath>

#include "shared/utc_text.h"

namespace bess {

void judge_inputs(Bench& bench) {
  constexpr double kSocToleranceE4 =
      100;  // a percent: resolution of registers, and what has flowed
  for (const CycleRecord& cycle : bench.evidence.log) {
    if (cycle.mode == Mode::kStopping) continue;
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    if (cycle.price.has_row) {
      const auto price = bench.publication.price_of(cycle.price.minute_utc_s);
      const double seen = cycle.price.price_centi_eur_per_mwh / 100.0;
      if (!price || std::abs(*price - seen) > 0.0051) {
        bench.find(
            tick_ns,
            fmt::format("{} for {}", price ? fmt::format("{:.2f} EUR/MWh", *price) : "no price",
                        utc_text(cycle.price.minute_utc_s).view()),
            fmt::format("{:.2f}", seen));
      }
    }
    if (!cycle.has_measurement || bench.is_disturbed(tick_ns)) continue;
    const double soc_e4 = 1e4 * bench.soc_at(tick_ns);
    const double flow_e4 = 1e4 * bench.scenario.battery.physics.power_w_max *
                           (60 + bench.evidence.slack_s) / 3'600 /
                           bench.scenario.battery.physics.capacity_wh;
    if (std::abs(soc_e4 - cycle.measurement.soc_e4) <= kSocToleranceE4 + flow_e4) continue;
    bench.find(tick_ns, fmt::format("a SoC near {:.4f}", soc_e4 / 1e4),
               fmt::format("{:.4f}", cycle.measurement.soc_e4 / 1e4));
  }
}

}  // namespace bess
