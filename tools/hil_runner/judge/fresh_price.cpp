#include "tools/hil_runner/judge/bench.h"

#include "shared/utc_text.h"

namespace bess {

void judge_fresh_price(Bench& bench) {
  bench.each_tick([&](std::int64_t tick_ns) {
    const auto fresh = bench.fresh_row(tick_ns);
    if ((fresh && !bench.must_be_frozen(*fresh)) || bench.is_disturbed_in_cycle(tick_ns)) return;
    if (!fresh && bench.may_stand_in(tick_ns)) return;
    const CommandInForce command = bench.commands.at(bench.settled_ns(tick_ns));
    if (command.power_w == 0) return;
    const auto row = bench.publication.newest(tick_ns);
    bench.find(
        bench.settled_ns(tick_ns),
        row ? fmt::format("0 W, the newest price being of {}", utc_text(row->minute_utc_s).view())
            : "0 W, there being no price",
        watts(command));
  });
}

}  // namespace bess
