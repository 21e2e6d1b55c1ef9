// The meter at the connection to the grid, through a register map of its own (kind = "meter"): one
// value, the power that flows in. Read by the same bus as the battery, with the same checks: the
// device must be the map's, and a value that is not plausible is no value. A template over link and
// time (battery_bus.h). Never writes.
#pragma once

#include <cstdint>
#include <utility>

#include "edge/battery/alive_watch.h"
#include "edge/battery/identity_check.h"
#include "edge/battery/measurement_reader.h"
#include "edge/registers/live_points.h"

namespace bess {

template <typename Link, typename Time>
class GridMeter {
 public:
  /// `map` must outlive this object; `unit` replaces its unit id when not negative.
  template <typename... LinkArguments>
  GridMeter(const RegisterMap& map, const Time& time, std::int32_t unit, LinkArguments&&... link)
      : map_(map), bus_(map, time, unit, std::forward<LinkArguments>(link)...), alive_(map) {}

  /// Import is positive. One attempt: the next look is seconds away, and the battery waits.
  /// kImplausible: another device, a value out of its range, or one that stands still.
  Status read(std::int32_t& grid_power_w) {
    if (!identified_) {
      IdentityFailure failure;
      if (const Status status = check_identity(failure); status != Status::kOk) return status;
    }
    if (const Status status = bus_.read_due(); status != Status::kOk) return status;
    std::int64_t power_w = 0;
    if (!live_power(map_, map_.grid_power, bus_.live(), power_w)) return Status::kImplausible;
    if (!alive_.is_alive(bus_.live(), bus_.time().now_ns())) return Status::kImplausible;
    grid_power_w = clamp_to_int32(power_w);
    return Status::kOk;
  }

  /// On kImplausible `failure` says which check of the map failed and what was read.
  Status check_identity(IdentityFailure& failure) {
    const Status status = check_identity_of(map_, bus_, failure);
    identified_ = status == Status::kOk;
    return status;
  }

 private:
  const RegisterMap& map_;
  BatteryBus<Link, Time> bus_;
  AliveWatch alive_;
  bool identified_ = false;
};

}  // namespace bess
