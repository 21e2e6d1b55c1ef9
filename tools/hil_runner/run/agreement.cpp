#include "tools/hil_runner/run/agreement.h"

#include <fmt/core.h>

#include <cstdlib>

namespace bess {
namespace {

constexpr std::int32_t kAlikeW = 10;

const Outcome* in_wall_time(const std::vector<Outcome>& outcomes, const Outcome& of) {
  for (const Outcome& o : outcomes) {
    const bool has_run = !o.is_virtual && o.skipped.empty() && o.error.empty();
    if (has_run && o.scenario.path == of.scenario.path) return &o;
  }
  return nullptr;
}

void compare(const Outcome& simulated, const Outcome& real, Agreement& agreement) {
  const std::vector<CycleRecord>& log = real.evidence.log;
  std::size_t r = 0;
  for (const CycleRecord& cycle : simulated.evidence.log) {
    while (r < log.size() && log[r].utc_s < cycle.utc_s) ++r;
    if (r == log.size()) return;
    // How a run ends is no order, and not at a tick.
    const bool is_both = log[r].utc_s == cycle.utc_s && cycle.mode != Mode::kStopping &&
                         log[r].mode != Mode::kStopping;
    if (!is_both) continue;
    ++agreement.cycles;
    if (std::abs(log[r].ordered_power_w - cycle.ordered_power_w) <= kAlikeW) continue;
    ++agreement.otherwise;
    if (!agreement.first.empty()) continue;
    agreement.first =
        fmt::format("{} at minute {}: {} W ({}), in wall time {} W ({})", simulated.scenario.name,
                    (cycle.utc_s - simulated.scenario.start_utc_s) / 60, cycle.ordered_power_w,
                    reason_name(cycle.reason), log[r].ordered_power_w, reason_name(log[r].reason));
  }
}

}  // namespace

Agreement agreement_of(const std::vector<Outcome>& outcomes) {
  Agreement agreement;
  for (const Outcome& outcome : outcomes) {
    if (!outcome.is_virtual || !outcome.skipped.empty()) continue;
    const Outcome* const real = in_wall_time(outcomes, outcome);
    if (real == nullptr) continue;
    ++agreement.scenarios;
    compare(outcome, *real, agreement);
  }
  return agreement;
}

std::string agreement_line(const Agreement& agreement) {
  if (agreement.scenarios == 0) return "";
  const std::string line =
      fmt::format("{} of {} cycles of {} scenarios ordered alike in both times",
                  agreement.cycles - agreement.otherwise, agreement.cycles, agreement.scenarios);
  return agreement.first.empty() ? line : line + "; not " + agreement.first;
}

}  // namespace bess
