#include "tools/hil_runner/judge/bench.h"

#include <algorithm>
#include <cmath>

#include "edge/control/quarter_hour_energy.h"

namespace bess {
namespace {

void judge_peaks(Bench& bench, double peak_w_max) {
  constexpr double kHours = 0.25;
  constexpr double kRoundTripWh = 10;  // of what it takes and gives back
  double import_wh = 0, battery_wh = 0;
  for (const MinuteRecord& m : bench.evidence.minutes) {
    if (m.minute_utc_s % kQuarterHourS == 0) import_wh = battery_wh = 0;
    import_wh += std::max(0.0, bench.house->power_w(m.minute_utc_s) / 60 + m.energy_wh);
    battery_wh += m.energy_wh;
    const bool is_over = m.minute_utc_s % kQuarterHourS == kQuarterHourS - 60;
    const bool is_above = import_wh > peak_w_max * kHours;
    if (!is_over || !is_above || battery_wh <= kRoundTripWh) continue;
    bench.find(
        m.minute_utc_s * kSecondNs,
        fmt::format("at most {:.0f} W in the mean of a quarter-hour", peak_w_max),
        fmt::format("{:.0f} W, {:.0f} Wh of it the battery's", import_wh / kHours, battery_wh));
  }
}

}  // namespace

/// By the house's load and what the battery recorded of itself, and not by what any meter showed.
void judge_connection(Bench& bench) {
  if (!bench.house) return;
  const ConnectionSettings& limits = bench.config.site.settings.connection;
  // Of the one in which the house rose, the edge's next look cuts what is too much.
  const int minutes_max = 1 + static_cast<int>(std::ceil((bench.evidence.slack_s) / 60));
  int minutes_over = 0;
  for (const MinuteRecord& m : bench.evidence.minutes) {
    const double battery_w = 60 * m.energy_wh;
    const double grid_w = bench.house->power_w(m.minute_utc_s) + battery_w;
    const bool is_over = (battery_w > 0 && grid_w > limits.import_w_max) ||
                         (battery_w < 0 && -grid_w > limits.export_w_max);
    minutes_over = is_over ? minutes_over + 1 : 0;
    if (minutes_over <= minutes_max) continue;
    bench.find(m.minute_utc_s * kSecondNs,
               battery_w > 0 ? fmt::format("at most {} W taken from the grid", limits.import_w_max)
                             : fmt::format("at most {} W given to the grid", limits.export_w_max),
               fmt::format("{:.0f} W, of which the battery {:.0f} W", grid_w, battery_w));
  }
  if (limits.peak_w_max != kAnyPowerW) judge_peaks(bench, limits.peak_w_max);
}

}  // namespace bess
