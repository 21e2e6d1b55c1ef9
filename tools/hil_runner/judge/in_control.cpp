#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_in_control(Bench& bench) {
  bench.each_tick([&](std::int64_t tick_ns) {
    const auto row = bench.fresh_row(tick_ns);
    if (!row || bench.may_be_frozen(*row) || bench.is_disturbed_in_cycle(tick_ns)) return;
    if (bench.commands.at(bench.settled_ns(tick_ns)).is_driven) return;
    bench.find(bench.settled_ns(tick_ns), "an order in force", "no order");
  });
}

}  // namespace bess
