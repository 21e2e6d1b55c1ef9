#include <signal.h>

#include <algorithm>
#include <cmath>

#include "tools/hil_runner/judge/bench.h"

namespace bess {

void judge_order(Bench& bench) {
  for (const CycleRecord& cycle : bench.evidence.log) {
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    const std::int64_t by_ns = bench.settled_at_worst_ns(tick_ns);
    const bool counts = cycle.mode == Mode::kRunning && cycle.written &&
                        by_ns < bench.scenario.end_utc_ns() && !bench.is_lost(tick_ns);
    const auto is_in_force = [&](std::int64_t utc_ns) {
      const CommandInForce command = bench.commands.at(utc_ns);
      return command.is_driven && std::abs(command.power_w - cycle.ordered_power_w) <= 2;
    };
    if (!counts || is_in_force(bench.settled_ns(tick_ns)) || is_in_force(by_ns)) continue;
    if (bench.was_cut(tick_ns, by_ns, cycle.ordered_power_w)) continue;
    bench.find(by_ns, fmt::format("{} W, as logged", cycle.ordered_power_w),
               watts(bench.commands.at(by_ns)));
  }
}

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
    // Includes the wait for a reply to the last write of an order.
    if (!is_new || !is_judged || after_tick_ns <= most_ns) continue;
    bench.find(
        e.utc_ns,
        fmt::format("an order within {} s of its tick", bench.config.control.order_deadline_s),
        fmt::format("{:.0f} W after {:.1f} s", e.power_w,
                    static_cast<double>(after_tick_ns) / 1e9));
  }
}

void judge_in_control(Bench& bench) {
  bench.each_tick([&](std::int64_t tick_ns) {
    const auto row = bench.fresh_row(tick_ns);
    if (!row || bench.may_be_frozen(*row) || bench.is_disturbed_in_cycle(tick_ns)) return;
    if (bench.commands.at(bench.settled_ns(tick_ns)).is_driven) return;
    bench.find(bench.settled_ns(tick_ns), "an order in force", "no order");
  });
}

void judge_fed(Bench& bench) {
  for (const DispatchEvent& e : bench.evidence.orders) {
    if (e.kind != DispatchEvent::Kind::kExpiry || bench.is_disturbed(e.utc_ns)) continue;
    if (e.utc_ns < bench.start_ns() || e.utc_ns >= bench.scenario.end_utc_ns()) continue;
    return bench.find(e.utc_ns, "an order that is refreshed in time", "it expired");
  }
}

namespace {

/// A stop requested by the scenario releases the battery immediately.
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
  std::int64_t since_ns = -1;  ///< start of 0 W
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
    return bench.find(e.utc_ns,
                      fmt::format("0 W for {} s before the release", bench.config.control.hold_s),
                      fmt::format("{:.0f} s", static_cast<double>(held_ns) / 1e9));
  }
}

void judge_released(Bench& bench) {
  if (bench.evidence.orders.empty()) return;
  const bool was_killed = bench.evidence.edge_exit_code == 128 + SIGKILL;
  if (was_killed && !bench.evidence.order_ends_by_itself) return;
  // The order of a killed edge expires by itself if the scenario is long enough.
  const CommandInForce last = bench.commands.at(INT64_MAX);
  if (last.is_driven)
    bench.find(bench.evidence.orders.back().utc_ns, "no order in force at the end", watts(last));
}

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
                        fmt::format("no power {} s after loss of link or process",
                                    bench.evidence.order_duration_s + kSecondsPerStep),
                        watts(command));
    }
  }
}

}  // namespace bess
