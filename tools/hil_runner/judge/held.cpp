#include "tools/hil_runner/judge/bench.h"

#include <algorithm>

namespace bess {
namespace {

/// An end that the scenario asks for gives the battery back at once.
bool is_way_out(const Bench& bench, std::int64_t utc_ns) {
  constexpr std::int64_t kPatienceNs = 75 * kSecondNs;
  const auto follows = [&](std::int64_t at_ns) {
    return utc_ns >= at_ns - bench.slack_ns() && utc_ns < at_ns + kPatienceNs + bench.slack_ns();
  };
  if (follows(bench.scenario.end_utc_ns())) return true;
  return std::ranges::any_of(bench.scenario.events, [&](const ScenarioEvent& event) {
    return event.does == ScenarioEvent::Does::kEdgeStop &&
           follows(bench.scenario.utc_ns_at(event.at_min));
  });
}

}  // namespace

void judge_held(Bench& bench) {
  std::int64_t since_ns = -1;  ///< of 0 W, held
  bool was_driven = false;
  for (const DispatchEvent& e : bench.evidence.orders) {
    if (e.kind == DispatchEvent::Kind::kOrder) {
      if (e.power_w != 0) since_ns = -1;
      if (e.power_w == 0 && since_ns < 0) since_ns = e.utc_ns;
      was_driven = true;
      continue;
    }
    const bool is_release = e.kind == DispatchEvent::Kind::kStop && was_driven;
    was_driven = false;
    const std::int64_t held_ns = since_ns < 0 ? 0 : e.utc_ns - since_ns;
    since_ns = -1;
    if (!is_release || is_way_out(bench, e.utc_ns) || bench.is_disturbed(e.utc_ns) ||
        e.utc_ns < bench.start_ns())
      continue;
    if (held_ns >= bench.config.control.hold_s * kSecondNs - bench.slack_ns()) continue;
    return bench.find(
        e.utc_ns, fmt::format("0 W for {} s before it is given back", bench.config.control.hold_s),
        fmt::format("{:.0f} s", static_cast<double>(held_ns) / 1e9));
  }
}

}  // namespace bess
