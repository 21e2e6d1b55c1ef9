#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_end(Bench& bench) {
  bench.rule = "end";
  if (bench.evidence.edge_exit_code != bench.scenario.exit_code) {
    bench.find(
        bench.scenario.end_utc_ns(),
        fmt::format("exit code {} of the edge", bench.scenario.exit_code),
        fmt::format("{} ({})", bench.evidence.edge_exit_code, bench.evidence.edge_last_line));
  }
  if (!bench.evidence.is_alive_at_end) {
    bench.find(bench.scenario.end_utc_ns(), "simulators that serve until the end",
               "one ended before");
  }
  if (bench.evidence.log.empty())
    bench.find(bench.scenario.end_utc_ns(), "a log of the edge", "none");
}

}  // namespace bess
