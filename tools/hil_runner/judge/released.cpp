#include "tools/hil_runner/judge/bench.h"

#include <signal.h>

namespace bess {

void judge_released(Bench& bench) {
  if (bench.evidence.orders.empty()) return;
  const bool was_killed = bench.evidence.edge_exit_code == 128 + SIGKILL;
  if (was_killed && !bench.evidence.order_ends_by_itself) return;
  // What a killed edge leaves runs out by itself, if the scenario goes on for long enough.
  const CommandInForce last = bench.commands.at(INT64_MAX);
  if (last.is_driven)
    bench.find(bench.evidence.orders.back().utc_ns, "no order left at the end", watts(last));
}

}  // namespace bess
