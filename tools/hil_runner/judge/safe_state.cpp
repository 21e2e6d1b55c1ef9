#include "tools/hil_runner/judge/bench.h"

#include <algorithm>

namespace bess {

void judge_safe_state(Bench& bench) {
  if (!bench.evidence.order_ends_by_itself) return;
  const std::int64_t timer_ns =
      bench.evidence.order_duration_s * kSecondNs + kStepNs + bench.slack_ns();
  for (const Window& window : bench.lost) {
    const std::int64_t end_ns = std::min(window.to_ns, bench.scenario.end_utc_ns());
    for (std::int64_t t = window.from_ns + timer_ns; t < end_ns; t += 10 * kSecondNs) {
      const CommandInForce command = bench.commands.at(t);
      if (command.power_w == 0) continue;
      return bench.find(t,
                        fmt::format("no power {} s after the link or the process was lost",
                                    bench.evidence.order_duration_s + kSecondsPerStep),
                        watts(command));
    }
  }
}

}  // namespace bess
