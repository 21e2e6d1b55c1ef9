#include <algorithm>
#include <cmath>

#include "edge/core/control/quarter_hour_energy.h"
#include "tools/hil_runner/judge/judge_context.h"

namespace bess {

void judge_power_limit(JudgeContext& judging) {
  const double most_w = judging.config.control.guard.power_w * 1.001 + 1;
  for (const DispatchEvent& e : judging.evidence.orders) {
    if (std::abs(e.power_w) <= most_w) continue;
    return judging.find(e.utc_ns, fmt::format("at most {} W", judging.config.control.guard.power_w),
                        fmt::format("an order of {:.0f} W", e.power_w));
  }
}

void judge_soc_window(JudgeContext& judging) {
  const GuardSettings& guard = judging.config.control.guard;
  const double low = guard.soc_min_e4 / 1e4 - judging.soc_margin_frac();
  const double high = guard.soc_max_e4 / 1e4 + judging.soc_margin_frac();
  for (const MinuteRecord& m : judging.evidence.minutes) {
    if (m.soc_frac >= low && m.soc_frac <= high) continue;
    return judging.find((m.minute_utc_s + 60) * kSecondNs,
                        fmt::format("a SoC from {:.4f} to {:.4f}", low, high),
                        fmt::format("{:.4f}", m.soc_frac));
  }
}

void judge_flash(JudgeContext& judging) {
  const std::int32_t most = judging.config.battery.map.writes.eeprom_writes_per_day;
  if (most == 0) return;
  for (const CycleRecord& cycle : judging.evidence.log) {
    const std::int32_t writes = cycle.counters.flash_writes_today;
    if (writes > most) {
      judging.find(cycle.utc_s * kSecondNs, fmt::format("at most {} flash writes per day", most),
                   fmt::format("{}", writes));
    }
  }
}

namespace {

void judge_peaks(JudgeContext& judging, double peak_w_max) {
  constexpr double kHours = 0.25;
  constexpr double kRoundTripWh = 10;  // of energy charged and discharged
  double import_wh = 0, battery_wh = 0;
  for (const MinuteRecord& m : judging.evidence.minutes) {
    if (m.minute_utc_s % kQuarterHourS == 0) import_wh = battery_wh = 0;
    import_wh += std::max(0.0, judging.house->power_w(m.minute_utc_s) / 60 + m.energy_wh);
    battery_wh += m.energy_wh;
    const bool is_over = m.minute_utc_s % kQuarterHourS == kQuarterHourS - 60;
    const bool is_above = import_wh > peak_w_max * kHours;
    if (!is_over || !is_above || battery_wh <= kRoundTripWh) continue;
    judging.find(
        m.minute_utc_s * kSecondNs,
        fmt::format("at most {:.0f} W as quarter-hour mean", peak_w_max),
        fmt::format("{:.0f} W, with {:.0f} Wh of the battery", import_wh / kHours, battery_wh));
  }
}

}  // namespace

/// From the house load and the battery trace, independent of any meter.
void judge_connection(JudgeContext& judging) {
  if (!judging.house) return;
  const ConnectionSettings& limits = judging.config.site.settings.connection;
  // In the minute of a load step, the edge reduces power at its next reading.
  const int minutes_max = 1 + static_cast<int>(std::ceil((judging.evidence.slack_s) / 60));
  int minutes_over = 0;
  for (const MinuteRecord& m : judging.evidence.minutes) {
    const double battery_w = 60 * m.energy_wh;
    const double grid_w = judging.house->power_w(m.minute_utc_s) + battery_w;
    const bool is_over = (battery_w > 0 && grid_w > limits.import_w_max) ||
                         (battery_w < 0 && -grid_w > limits.export_w_max);
    minutes_over = is_over ? minutes_over + 1 : 0;
    if (minutes_over <= minutes_max) continue;
    judging.find(m.minute_utc_s * kSecondNs,
                 battery_w > 0 ? fmt::format("at most {} W import", limits.import_w_max)
                               : fmt::format("at most {} W export", limits.export_w_max),
                 fmt::format("{:.0f} W, with {:.0f} W of the battery", grid_w, battery_w));
  }
  if (limits.peak_w_max != kAnyPowerW) judge_peaks(judging, limits.peak_w_max);
}

void judge_energy(JudgeContext& judging) {
  const BatteryParameters& p = judging.scenario.battery.physics;
  double stored_wh = 0;
  double moved_wh = 0;
  double unknown_wh = 0.5;
  double before_wh = 0;
  const double lost_wh_max = p.full_power_loss_frac * p.power_w_max / 60;  // per minute
  for (const MinuteRecord& m : judging.evidence.minutes) {
    const double flow_wh = m.energy_wh - p.standby_w / 60;
    // The trace has only sums of a minute: unknown are losses of a minute with charging and
    // discharging (slowest response: 5 s), and losses that grow with the square of power.
    if (flow_wh * before_wh < 0) {
      unknown_wh += p.power_w_max * (6 + judging.evidence.slack_s) / 3'600 *
                    (1 / p.discharge_efficiency - p.charge_efficiency);
    }
    if (std::abs(flow_wh - before_wh) > 0.01 * p.power_w_max / 60) unknown_wh += lost_wh_max;
    before_wh = flow_wh;
    stored_wh += stored_power_w(p, 60 * flow_wh) / 60;
    moved_wh += std::abs(m.energy_wh);
  }
  if (judging.evidence.minutes.empty()) return;
  const MinuteRecord& last = judging.evidence.minutes.back();
  const double by_soc_wh = (last.soc_frac - judging.scenario.battery.soc_frac) * p.capacity_wh;
  if (std::abs(stored_wh - by_soc_wh) <= 0.001 * moved_wh + unknown_wh) return;
  judging.find((last.minute_utc_s + 60) * kSecondNs,
               fmt::format("{:.1f} Wh stored, from the energy", stored_wh),
               fmt::format("{:.1f} Wh from the SoC", by_soc_wh));
}

}  // namespace bess
