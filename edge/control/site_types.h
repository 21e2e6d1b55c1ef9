// What is measured and limited beyond the battery: the house behind the same meter, its connection
// to the grid, and whoever may cap the battery's power from outside.
//   meter -> SiteReport -> log            limits -> SiteRange -> guard (site_range.h)
// Grid power is positive for import, house load for consumption (negative: more sun than load).
#pragma once

#include <cstdint>

#include "edge/base/status.h"

namespace bess {

/// Where a limit in W is not set.
inline constexpr std::int32_t kAnyPowerW = INT32_MAX;

/// The site's part of one cycle, for the log. All zero where neither meter nor limits are configured.
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
};

}  // namespace bess
