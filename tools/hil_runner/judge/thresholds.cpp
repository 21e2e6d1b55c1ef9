#include <algorithm>
#include <cmath>

#include "edge/control/cycle_budget.h"
#include "edge/control/reserve.h"
#include "shared/local_time.h"
#include "tools/hil_runner/judge/bench.h"

namespace bess {
namespace {

/// What the operator or another program asks for stands above the thresholds: what of it is in
/// force at a tick.
struct Said {
  bool is_held = false;
  bool is_limited = false;  ///< or was: an unreadable limit leaves the one before in doubt
};

Said said_at(const Bench& bench, std::int64_t tick_ns) {
  using enum ScenarioEvent::Does;
  Said said;
  for (const ScenarioEvent& event : bench.scenario.events) {
    const std::int64_t at_ns = bench.scenario.utc_ns_at(event.at_min);
    if (at_ns > tick_ns + bench.slack_ns()) break;
    const bool is_on = tick_ns < at_ns + event.for_s * kSecondNs + bench.slack_ns();
    if (event.does == kHold) said.is_held = is_on;
    if (event.does == kHoldRelease) said.is_held = false;
    if (event.does == kLimit || event.does == kLimitTorn) said.is_limited = is_on;
    if (event.does == kLimitClear) said.is_limited = false;
  }
  const bool needs_limit = bench.config.site.settings.idle_after_timeout;
  said.is_limited = said.is_limited || (needs_limit && bench.scenario.has_limits());
  return said;
}

/// By the battery's own record: what was moved on the local day of a tick reaches the budget, but
/// for what its display rounds.
bool may_be_spent(const Bench& bench, std::int64_t tick_ns) {
  const std::int32_t budget_e4 = bench.config.control.cycles_per_day_max_e4;
  if (budget_e4 == 0) return false;
  const std::int64_t tick_utc_s = tick_ns / kSecondNs;
  const std::int32_t day = local_day_of(local_minute_of(tick_utc_s));
  double moved_frac = 0;
  double before_frac = bench.scenario.battery.soc_frac;
  for (const MinuteRecord& minute : bench.evidence.minutes) {
    if (minute.minute_utc_s >= tick_utc_s) break;
    if (local_day_of(local_minute_of(minute.minute_utc_s)) == day) {
      moved_frac += std::abs(minute.soc_frac - before_frac);
    }
    before_frac = minute.soc_frac;
  }
  return 1e4 * (moved_frac / 2 + bench.soc_margin_frac()) >= budget_e4;
}

/// As many orders of the last hour as the cap allows went the other way than the one before.
bool may_be_barred(const Bench& bench, std::int64_t tick_ns, double wanted_w) {
  const std::int32_t most = bench.config.control.reversals_per_hour_max;
  if (most == 0) return false;
  std::int32_t reversals = 0;
  double last_w = 0;
  for (const DispatchEvent& e : bench.evidence.orders) {
    if (e.utc_ns >= tick_ns) break;
    if (e.kind != DispatchEvent::Kind::kOrder || e.power_w == 0) continue;
    const bool is_in_hour = e.utc_ns >= tick_ns - 3'600 * kSecondNs;
    if (is_in_hour && e.power_w * last_w < 0) ++reversals;
    last_w = e.power_w;
  }
  return reversals >= most && wanted_w * last_w < 0;
}

/// As far towards it as the ramp lets one order go.
double ramped_w(const Bench& bench, std::int64_t tick_ns, double wanted_w) {
  const double ramp_w = bench.config.control.guard.ramp_w_max;
  if (ramp_w == 0) return wanted_w;
  const double from_w = bench.commands.at(tick_ns).power_w;
  return std::clamp(wanted_w, from_w - ramp_w, from_w + ramp_w);
}

/// The state of charge forbids it: of the window, or of what is kept for a black-out.
bool is_full_or_empty(const Bench& bench, std::int64_t tick_ns, bool charges) {
  const GuardSettings& guard = bench.config.control.guard;
  const double soc_e4 = 1e4 * bench.soc_at(tick_ns);
  const double margin_e4 = guard.soc_hysteresis_e4 + 1e4 * bench.soc_margin_frac();
  if (charges) return soc_e4 > guard.soc_max_e4 - margin_e4;
  const LocalMinute now = local_minute_of(tick_ns / kSecondNs);
  const std::int32_t reserve_e4 = reserve_soc_e4_at(bench.config.control.reserve, now);
  return soc_e4 < std::max(guard.soc_min_e4, reserve_e4) + margin_e4;
}

/// What the house's connection allows, or a meter that is wrong about it, may cut an order.
bool has_connection(const Bench& bench) {
  const Scenario& scenario = bench.scenario;
  return bench.house.has_value() &&
         (!scenario.edge_meter.empty() || !scenario.meter.fault.schedule.faults.empty());
}

}  // namespace

void judge_thresholds(Bench& bench) {
  const GuardSettings& guard = bench.config.control.guard;
  bench.each_tick([&](std::int64_t tick_ns) {
    const auto row = bench.fresh_row(tick_ns);
    if (!row || bench.may_be_frozen(*row) || bench.is_disturbed_in_cycle(tick_ns)) return;
    const double price = row->eur_per_mwh;
    const bool is_low = price <= guard.thresholds.low_eur_per_mwh;
    const bool is_high = price >= guard.thresholds.high_eur_per_mwh;
    if ((!is_low && !is_high) || is_full_or_empty(bench, tick_ns, is_low)) return;
    const Said said = said_at(bench, tick_ns);
    if (said.is_held || may_be_spent(bench, tick_ns)) return;
    const double extreme_w = is_low ? guard.power_w : -guard.power_w;
    if (may_be_barred(bench, tick_ns, extreme_w)) return;
    const double wanted_w = ramped_w(bench, tick_ns, extreme_w);
    const CommandInForce command = bench.commands.at(bench.settled_ns(tick_ns));
    if (std::abs(command.power_w - wanted_w) <= 0.01 * guard.power_w) return;
    const bool is_cut = said.is_limited || has_connection(bench);
    if (is_cut && bench.may_be_cut(wanted_w, command.power_w)) return;
    bench.find(bench.settled_ns(tick_ns),
               fmt::format("{:.0f} W at {:.2f} EUR/MWh", wanted_w, price), watts(command));
  });
}

}  // namespace bess
