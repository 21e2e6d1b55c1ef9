#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_power_limit(Bench& bench) {
  const double most_w = bench.config.control.guard.power_w * 1.001 + 1;
  for (const DispatchEvent& e : bench.evidence.orders) {
    if (std::abs(e.power_w) <= most_w) continue;
    return bench.find(e.utc_ns, fmt::format("at most {} W", bench.config.control.guard.power_w),
                      fmt::format("an order of {:.0f} W", e.power_w));
  }
}

}  // namespace bess
