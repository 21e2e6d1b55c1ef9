#include <signal.h>

#include <algorithm>
#include <cmath>

#include "tools/hil_runner/judge/judge_context.h"

namespace bess {

void judge_order(JudgeContext& judging) {
  for (const CycleRecord& cycle : judging.evidence.log) {
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    const std::int64_t by_ns = judging.settled_at_worst_ns(tick_ns);
    const bool counts = cycle.mode == Mode::kRunning && cycle.written &&
                        by_ns < judging.scenario.end_utc_ns() && !judging.is_lost(tick_ns);
    const auto is_in_force = [&](std::int64_t utc_ns) {
      const CommandInForce command = judging.command_at(utc_ns);
      return command.is_driven && std::abs(command.power_w - cycle.ordered_power_w) <= 2;
    };
    if (!counts || is_in_force(judging.settled_ns(tick_ns)) || is_in_force(by_ns)) continue;
    if (judging.was_cut(tick_ns, by_ns, cycle.ordered_power_w)) continue;
    judging.find(by_ns, fmt::format("{} W, as logged", cycle.ordered_power_w),
                 watts(judging.command_at(by_ns)));
  }
}

void judge_in_time(JudgeContext& judging) {
  CommandInForce before;
  for (const DispatchEvent& e : judging.evidence.orders) {
    const CommandInForce now = {.is_driven = e.kind == DispatchEvent::Kind::kOrder,
                                .power_w = e.power_w};
    const bool is_cut = judging.may_be_cut(before.power_w, now.power_w);
    const bool is_new =
        now.is_driven && now.power_w != 0 && !is_cut && std::abs(now.power_w - before.power_w) > 2;
    before = now;
    const std::int64_t after_tick_ns = e.utc_ns % kStepNs;
    const bool is_judged =
        e.utc_ns >= judging.start_ns() && e.utc_ns < judging.scenario.end_utc_ns();
    const std::int64_t most_ns =
        judging.config.control.order_deadline_s * kSecondNs + judging.slack_ns();
    // Includes the wait for a reply to the last write of an order.
    if (!is_new || !is_judged || after_tick_ns <= most_ns) continue;
    judging.find(
        e.utc_ns,
        fmt::format("an order within {} s of its tick", judging.config.control.order_deadline_s),
        fmt::format("{:.0f} W after {:.1f} s", e.power_w,
                    static_cast<double>(after_tick_ns) / 1e9));
  }
}

void judge_in_control(JudgeContext& judging) {
  judging.each_tick([&](std::int64_t tick_ns) {
    const auto row = judging.fresh_row(tick_ns);
    if (!row || judging.may_be_frozen(*row) || judging.is_disturbed_in_cycle(tick_ns)) return;
    if (judging.command_at(judging.settled_ns(tick_ns)).is_driven) return;
    judging.find(judging.settled_ns(tick_ns), "an order in force", "no order");
  });
}

void judge_fed(JudgeContext& judging) {
  for (const DispatchEvent& e : judging.evidence.orders) {
    if (e.kind != DispatchEvent::Kind::kExpiry || judging.is_disturbed(e.utc_ns)) continue;
    if (e.utc_ns < judging.start_ns() || e.utc_ns >= judging.scenario.end_utc_ns()) continue;
    return judging.find(e.utc_ns, "an order that is refreshed in time", "it expired");
  }
}

namespace {

/// A stop requested by the scenario releases the battery immediately.
bool is_way_out(const JudgeContext& judging, std::int64_t utc_ns) {
  constexpr std::int64_t kPatienceNs = 75 * kSecondNs;
  const auto follows = [&](std::int64_t at_ns) {
    return utc_ns >= at_ns - judging.slack_ns() &&
           utc_ns < at_ns + kPatienceNs + judging.slack_ns();
  };
  if (follows(judging.scenario.end_utc_ns())) return true;
  return std::ranges::any_of(judging.scenario.events, [&](const ScenarioEvent& event) {
    return event.kind == ScenarioEvent::EventKind::kEdgeStop &&
           follows(judging.scenario.utc_ns_at(event.at_min));
  });
}

}  // namespace

void judge_held(JudgeContext& judging) {
  std::int64_t since_ns = -1;  ///< start of 0 W
  bool was_driven = false;
  for (const DispatchEvent& e : judging.evidence.orders) {
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
    if (!is_release || is_way_out(judging, e.utc_ns) || judging.is_disturbed(e.utc_ns) ||
        e.utc_ns < judging.start_ns())
      continue;
    if (held_ns >= judging.config.control.hold_s * kSecondNs - judging.slack_ns()) continue;
    return judging.find(
        e.utc_ns, fmt::format("0 W for {} s before the release", judging.config.control.hold_s),
        fmt::format("{:.0f} s", static_cast<double>(held_ns) / 1e9));
  }
}

void judge_released(JudgeContext& judging) {
  if (judging.evidence.orders.empty()) return;
  const bool was_killed = judging.evidence.edge_exit_code == 128 + SIGKILL;
  if (was_killed && !judging.config.control.has_watchdog) return;
  // The order of a killed edge expires by itself if the scenario is long enough.
  const CommandInForce last = judging.command_at(INT64_MAX);
  if (last.is_driven)
    judging.find(judging.evidence.orders.back().utc_ns, "no order in force at the end",
                 watts(last));
}

void judge_safe_state(JudgeContext& judging) {
  if (!judging.config.control.has_watchdog) return;
  const std::int64_t timer_ns =
      judging.config.control.order_duration_s * kSecondNs + kStepNs + judging.slack_ns();
  for (const Window& window : judging.lost) {
    const std::int64_t end_ns = std::min(window.to_ns, judging.scenario.end_utc_ns());
    for (std::int64_t t = window.from_ns + timer_ns; t < end_ns; t += 10 * kSecondNs) {
      const CommandInForce command = judging.command_at(t);
      if (command.power_w == 0) continue;
      return judging.find(t,
                          fmt::format("no power {} s after loss of link or process",
                                      judging.config.control.order_duration_s + kSecondsPerStep),
                          watts(command));
    }
  }
}

}  // namespace bess
