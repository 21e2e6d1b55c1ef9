#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_order(Bench& bench) {
  for (const CycleRecord& cycle : bench.evidence.log) {
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    const std::int64_t by_ns = bench.settled_at_worst_ns(tick_ns);
    const bool counts = cycle.mode == Mode::kRunning && cycle.written &&
                        by_ns < bench.scenario.end_utc_ns() && !bench.is_lost(tick_ns);
    const auto is_in_force = [&](std::int64_t utc_ns) {
      const CommandInForce command = bench.commands.at(utc_ns);
      return command.is_driven && std::abs(command.power_w - cycle.ordered_power_w) <= 2;
    };
    if (!counts || is_in_force(bench.settled_ns(tick_ns)) || is_in_force(by_ns)) continue;
    if (bench.was_cut(tick_ns, by_ns, cycle.ordered_power_w)) continue;
    bench.find(by_ns, fmt::format("{} W, as logged", cycle.ordered_power_w),
               watts(bench.commands.at(by_ns)));
  }
}

}  // namespace bess
