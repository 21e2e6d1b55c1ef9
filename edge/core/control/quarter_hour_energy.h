// Energy of the current quarter-hour: import, and the battery's share. The Belgian capacity tariff
// uses its mean. Pure integers, updated with every reading. Between two readings import is the mean
// of both (export is not credited). Battery power is the higher of the two: orders change it
// between readings, and it must not be underestimated.
//
// Unmeasured time (a gap longer than `gap_s_max`, or before the first reading) counts as the cap,
// or as a higher neighbouring reading. After a restart the rest of the quarter-hour keeps its own
// share of the cap and no more.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/units_and_limits.h"

namespace bess {

inline constexpr std::int64_t kQuarterHourS = kMinutesPerQuarterHour * 60;

/// Local quarter-hours are UTC quarter-hours: every offset in use is a multiple of 15 minutes.
constexpr std::int64_t quarter_hour_of(std::int64_t utc_s) { return utc_s / kQuarterHourS; }

class QuarterHourEnergy {
 public:
  struct Sums {
    std::int64_t import_ws = 0;
    std::int64_t battery_ws = 0;  ///< net, charged less discharged; not below 0
    std::int32_t left_s = 0;      ///< of the quarter-hour, 1 to 900
  };

  QuarterHourEnergy(std::int32_t assumed_w, std::int32_t gap_s_max)
      : assumed_w_(assumed_w), gap_s_max_(gap_s_max) {}

  /// Count of an earlier run up to `utc_s`.
  void restore(std::int64_t utc_s, std::int32_t import_wh, std::int32_t battery_wh) {
    last_utc_s_ = utc_s;
    is_restored_ = true;
    import_ws_ = std::int64_t{import_wh} * kWsPerWh;
    battery_ws_ = std::int64_t{battery_wh} * kWsPerWh;
  }

  /// A reading at `utc_s`. A clock step backwards resets the sums.
  void add(std::int64_t utc_s, std::int32_t grid_w, std::int32_t battery_w) {
    const std::int64_t quarter_start_s = quarter_hour_of(utc_s) * kQuarterHourS;
    const bool goes_on = last_utc_s_ >= quarter_start_s && last_utc_s_ <= utc_s;
    if (!goes_on) import_ws_ = battery_ws_ = 0;
    const bool follows = !is_restored_ && last_utc_s_ <= utc_s && utc_s - last_utc_s_ <= gap_s_max_;
    const std::int64_t seconds = utc_s - (goes_on ? last_utc_s_ : quarter_start_s);
    const std::int64_t import_w = std::max(grid_w, 0);
    const std::int64_t import_before_w = std::max(last_grid_w_, 0);
    if (follows) {
      import_ws_ += (import_w + import_before_w + 1) / 2 * seconds;
      battery_ws_ += std::max<std::int64_t>(battery_w, last_battery_w_) * seconds;
    } else {
      import_ws_ += std::max({import_w, import_before_w, std::int64_t{assumed_w_}}) * seconds;
      battery_ws_ += std::max<std::int64_t>({battery_w, last_battery_w_, 0}) * seconds;
    }
    battery_ws_ = std::max<std::int64_t>(battery_ws_, 0);
    last_utc_s_ = utc_s;
    last_grid_w_ = grid_w;
    last_battery_w_ = battery_w;
    is_restored_ = false;
  }

  /// Sums shortly after the last reading, extrapolated at constant power.
  [[nodiscard]] Sums at(std::int64_t utc_s) const {
    QuarterHourEnergy then = *this;
    then.add(std::max(utc_s, last_utc_s_), last_grid_w_, last_battery_w_);
    return {.import_ws = then.import_ws_,
            .battery_ws = then.battery_ws_,
            .left_s = static_cast<std::int32_t>(
                (quarter_hour_of(then.last_utc_s_) + 1) * kQuarterHourS - then.last_utc_s_)};
  }

  static constexpr std::int64_t kWsPerWh = 3'600;

 private:
  std::int32_t assumed_w_;
  std::int32_t gap_s_max_;
  bool is_restored_ = false;  ///< no measurement since the restored count
  std::int64_t last_utc_s_ = INT64_MIN / 2;
  std::int32_t last_grid_w_ = 0;
  std::int32_t last_battery_w_ = 0;
  std::int64_t import_ws_ = 0;
  std::int64_t battery_ws_ = 0;
};

}  // namespace bess
