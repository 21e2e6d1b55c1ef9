// What is measured and limited beyond the battery: the house behind the same meter, its connection
// to the grid, and whoever may cap the battery's power from outside.
//   meter -> SiteReport -> log            limits -> SiteRange -> guard
// Grid power is positive for import, house load for consumption (negative: more sun than load).
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/core/control/reasons.h"

namespace bess {

/// Where a limit in W is not set.
inline constexpr std::int32_t kAnyPowerW = INT32_MAX;

/// How far the meter is believed, and why (meter_witness.h). All zero: nothing speaks against it.
struct MeterTrust {
  bool is_mismatch = false;            ///< found: it does not step with the battery
  std::int32_t doubt = 0;              ///< points, 9 are a finding
  std::int64_t pause_until_utc_s = 0;  ///< of the last finding
  std::int32_t pause_s = 0;
  /// Sums over the last steps, in permille of the battery's rating: its steps, the meter's errors.
  std::int32_t steps = 0;
  std::int64_t step_squares = 0;
  std::int64_t error_products = 0;
  std::int64_t error_squares = 0;
};

/// The site's part of one cycle, for the log. All zero where neither meter nor limits are
/// configured.
struct SiteReport {
  bool has_grid_power = false;  ///< the meter was read, and lately enough to decide by it
  std::int32_t grid_power_w = 0;
  std::int32_t quarter_hour_import_wh = 0;  ///< imported in this quarter-hour, rounded up
  /// Of it, what the battery took and has not given back.
  std::int32_t quarter_hour_battery_wh = 0;
  std::int32_t order_cuts = 0;        ///< orders cut between two cycles, since start
  Status meter_status = Status::kOk;  ///< of the last reading
  /// kTimeout: the outside limit has lapsed, kMalformed: it cannot be understood.
  Status limit_status = Status::kOk;
  bool house_is_implausible = false;  ///< meter_witness.h
  MeterTrust trust{};
};

/// How far an order may go, by the site: the result of meter and outside limits, the guard's input.
/// Always contains 0 W: a limit takes power away and never asks for any; what asks is `relief_w`.
struct SiteRange {
  std::int32_t charge_w_max = kAnyPowerW;     ///< 0 or more
  std::int32_t discharge_w_max = kAnyPowerW;  ///< 0 or more
  Reason charge_reason{};                     ///< what set the limit, where there is one
  Reason discharge_reason{};
  /// To be discharged at least, so that the quarter-hour stays under its cap; within SoC, cycle and
  /// power limits, and within `discharge_w_max`.
  std::int32_t relief_w = 0;

  /// The tightest limit names the reason; of equal ones the first.
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
