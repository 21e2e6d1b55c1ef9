#include "tools/hil_runner/judge/bench.h"

#include <cmath>

namespace bess {

void judge_in_time(Bench& bench) {
  CommandInForce before;
  for (const DispatchEvent& e : bench.evidence.orders) {
    const CommandInForce now = {.is_driven = e.kind == DispatchEvent::Kind::kOrder,
                                .power_w = e.power_w};
    const bool is_cut = bench.may_be_cut(before.power_w, now.power_w);
    const bool is_new =
        now.is_driven && now.power_w != 0 && !is_cut && std::abs(now.power_w - before.power_w) > 2;
    before = now;
    const std::int64_t after_tick_ns = e.utc_ns % kStepNs;
    const bool is_judged = e.utc_ns >= bench.start_ns() && e.utc_ns < bench.scenario.end_utc_ns();
    const std::int64_t most_ns =
        bench.config.control.order_deadline_s * kSecondNs + bench.slack_ns();
    // The wait for a reply to the last write of an order counts, that order's bytes are on their
    // way.
    if (!is_new || !is_judged || after_tick_ns <= most_ns) continue;
    bench.find(
        e.utc_ns,
        fmt::format("an order within {} s of its tick", bench.config.control.order_deadline_s),
        fmt::format("{:.0f} W after {:.1f} s", e.power_w,
                    static_cast<double>(after_tick_ns) / 1e9));
  }
}

}  // namespace bess
