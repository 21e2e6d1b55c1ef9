#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_fed(Bench& bench) {
  for (const DispatchEvent& e : bench.evidence.orders) {
    if (e.kind != DispatchEvent::Kind::kExpiry || bench.is_disturbed(e.utc_ns)) continue;
    if (e.utc_ns < bench.start_ns() || e.utc_ns >= bench.scenario.end_utc_ns()) continue;
    return bench.find(e.utc_ns, "an order that is fed in time", "it ran out");
  }
}

}  // namespace bess
