#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_soc_window(Bench& bench) {
  const GuardSettings& guard = bench.config.control.guard;
  const double low = guard.soc_min_e4 / 1e4 - bench.soc_margin_frac();
  const double high = guard.soc_max_e4 / 1e4 + bench.soc_margin_frac();
  for (const MinuteRecord& m : bench.evidence.minutes) {
    if (m.soc_frac >= low && m.soc_frac <= high) continue;
    return bench.find((m.minute_utc_s + 60) * kSecondNs,
                      fmt::format("a SoC from {:.4f} to {:.4f}", low, high),
                      fmt::format("{:.4f}", m.soc_frac));
  }
}

}  // namespace bess
