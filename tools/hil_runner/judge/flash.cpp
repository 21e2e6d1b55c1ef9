#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_flash(Bench& bench) {
  const std::int32_t most = bench.config.battery.map.writes.eeprom_writes_per_day;
  if (most == 0) return;
  for (const CycleRecord& cycle : bench.evidence.log) {
    const std::int32_t writes = cycle.counters.flash_writes_today;
    if (writes > most) {
      bench.find(cycle.utc_s * kSecondNs, fmt::format("{} writes of its flash a day at most", most),
                 fmt::format("{}", writes));
    }
  }
}

}  // namespace bess
