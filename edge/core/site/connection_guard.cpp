#include "edge/core/site/connection_guard.h"

#include <algorithm>

namespace bess {
namespace {

constexpr std::int64_t divided_up(std::int64_t value, std::int64_t divisor) {
  return value > 0 ? (value + divisor - 1) / divisor : 0;
}

std::int64_t house_w_of(const ConnectionState& state) {
  return std::int64_t{state.grid_w} - state.battery_w;
}

/// Energy left in the quarter-hour at constant house load, W s; negative: too much used.
std::int64_t slack_ws(std::int64_t cap_w, std::int64_t house_w,
                      const QuarterHourEnergy::Sums& quarter) {
  return cap_w * kQuarterHourS - quarter.import_ws - house_w * quarter.left_s;
}

void limit_quarter_hour(const ConnectionSettings& settings, std::int64_t cap_w,
                        const ConnectionState& state, SiteRange& range) {
  const std::int64_t house_w = house_w_of(state);
  const QuarterHourEnergy::Sums& now = state.quarter_hour;
  const std::int64_t slack = slack_ws(cap_w, house_w, now);
  range.limit_charge(slack / now.left_s, Reason::kQuarterHourPeak);
  // The order of this step continues into the next quarter-hour, which starts at zero.
  if (now.left_s < kSecondsPerStep) {
    range.limit_charge(cap_w - house_w, Reason::kQuarterHourPeak);
  }
  const std::int64_t wanted_ws = std::max<std::int64_t>(-slack, 0);
  const std::int64_t bound_ws = settings.peak_shave ? wanted_ws : now.battery_ws;
  const std::int64_t relief_w = divided_up(std::min(wanted_ws, bound_ws), now.left_s);
  // At most the house load: export does not lower the mean.
  range.relief_w = static_cast<std::int32_t>(std::clamp<std::int64_t>(
      relief_w, 0, std::min<std::int64_t>(std::max<std::int64_t>(house_w, 0), kAnyPowerW)));
}

}  // namespace

void limit_at_connection(const ConnectionSettings& settings, std::int32_t margin_w,
                         const ConnectionState& state, SiteRange& range) {
  const std::int64_t house_w = house_w_of(state);
  if (settings.import_w_max != kAnyPowerW) {
    range.limit_charge(std::int64_t{settings.import_w_max} - margin_w - house_w,
                       Reason::kImportLimit);
  }
  if (settings.export_w_max != kAnyPowerW) {
    range.limit_discharge(std::int64_t{settings.export_w_max} - margin_w + house_w,
                          Reason::kExportLimit);
  }
  if (settings.peak_w_max != kAnyPowerW) {
    limit_quarter_hour(settings, std::int64_t{settings.peak_w_max} - margin_w, state, range);
  }
}

}  // namespace bess
