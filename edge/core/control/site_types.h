// Site measurements and limits: house, grid connection, outside limit.
//   meter -> SiteReport -> log            limits -> SiteRange -> guard
// Grid power is positive for import, house load for consumption (negative: more PV than load).
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/core/control/reasons.h"

namespace bess {

/// No limit, in W.
inline constexpr std::int32_t kAnyPowerW = INT32_MAX;

/// Trust in the meter, and its evidence (meter_check.h). All zero: no doubt.
struct MeterTrust {
  bool is_mismatch = false;            ///< finding: the meter does not step with the battery
  std::int32_t doubt = 0;              ///< points; 10 are a finding
  std::int64_t pause_until_utc_s = 0;  ///< pause after the last finding
  std::int32_t pause_s = 0;
  /// Sums over the last steps, in permille of the battery's rating: battery steps, meter errors.
  std::int32_t steps = 0;
  std::int64_t step_squares = 0;
  std::int64_t error_products = 0;
  std::int64_t error_squares = 0;
};

/// The site's part of one cycle, for the log. All zero without meter and limits.
struct SiteReport {
  bool has_grid_power = false;  ///< the meter was read recently enough to decide by it
  std::int32_t grid_power_w = 0;
  std::int32_t quarter_hour_import_wh = 0;  ///< imported in this quarter-hour, rounded up
  /// Share of it that the battery took and has not returned.
  std::int32_t quarter_hour_battery_wh = 0;
  std::int32_t order_cuts = 0;        ///< orders cut between two cycles, since start
  Status meter_status = Status::kOk;  ///< of the last reading
  /// kTimeout: the outside limit has lapsed; kMalformed: it cannot be parsed.
  Status limit_status = Status::kOk;
  bool house_is_implausible = false;  ///< meter_check.h
  MeterTrust trust{};
};

/// Range of an order at the site: result of meter and outside limits, input of the guard. Always
/// contains 0 W: a limit only reduces power; `relief_w` requests it.
struct SiteRange {
  std::int32_t charge_w_max = kAnyPowerW;     ///< 0 or more
  std::int32_t discharge_w_max = kAnyPowerW;  ///< 0 or more
  Reason charge_reason{};                     ///< reason of the limit, if any
  Reason discharge_reason{};
  /// Minimum discharge that keeps the quarter-hour under its cap; within SoC, full-cycle and power
  /// limits, and within `discharge_w_max`.
  std::int32_t relief_w = 0;

  /// The tightest limit sets the reason; of equal limits the first.
  constexpr void limit_charge(std::int64_t power_w, Reason reason) {
    limit(power_w, reason, charge_w_max, charge_reason);
  }
  constexpr void limit_discharge(std::int64_t power_w, Reason reason) {
    limit(power_w, reason, discharge_w_max, discharge_reason);
  }
  constexpr void forbid(Reason reason) {
    limit_charge(0, reason);
    limit_discharge(0, reason);
  }

 private:
  static constexpr void limit(std::int64_t power_w, Reason reason, std::int32_t& power_w_max,
                              Reason& because) {
    if (power_w < 0) power_w = 0;
    if (power_w >= power_w_max) return;
    power_w_max = static_cast<std::int32_t>(power_w);
    because = reason;
  }
};

}  // namespace bess
