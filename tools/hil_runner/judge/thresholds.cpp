#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_thresholds(Bench& bench) {
  const GuardSettings& guard = bench.config.control.guard;
  bench.each_tick([&](std::int64_t tick_ns) {
    const auto row = bench.fresh_row(tick_ns);
    if (!row || bench.may_be_frozen(*row) || bench.is_disturbed_in_cycle(tick_ns)) return;
    const double price = row->eur_per_mwh;
    const bool is_low = price <= guard.thresholds.low_eur_per_mwh;
    const bool is_high = price >= guard.thresholds.high_eur_per_mwh;
    if (!is_low && !is_high) return;
    const double soc_e4 = 1e4 * bench.soc_at(tick_ns);
    const double margin_e4 = guard.soc_hysteresis_e4 + 1e4 * bench.soc_margin_frac();
    if (is_low && soc_e4 > guard.soc_max_e4 - margin_e4) return;
    if (is_high && soc_e4 < guard.soc_min_e4 + margin_e4) return;
    const double wanted_w = is_low ? guard.power_w : -guard.power_w;
    const CommandInForce command = bench.commands.at(bench.settled_ns(tick_ns));
    if (std::abs(command.power_w - wanted_w) <= 0.01 * guard.power_w) return;
    bench.find(bench.settled_ns(tick_ns),
               fmt::format("{:.0f} W at {:.2f} EUR/MWh", wanted_w, price), watts(command));
  });
}

}  // namespace bess
