// Modbus battery and meter: battery driver and grid meter over libmodbus, in the time of the
// configured clock.
#pragma once

#include <cstdint>
#include <utility>

#include "edge/device/battery/battery_driver.h"
#include "edge/device/battery/measurement_reader.h"
#include "edge/device/battery/modbus_link.h"
#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

// Grid meter through a register map of its own (kind = "meter"): one value, the import power. It
// uses the battery's bus and checks: the device must match the map, and an implausible value is
// invalid. A template over link and time (battery_bus.h). Never writes.

template <typename Link, typename Time>
class GridMeter {
 public:
  /// `map` must outlive this object; `unit` replaces its unit id if not negative.
  template <typename... LinkArguments>
  GridMeter(const RegisterMap& map, const Time& time, std::int32_t unit, LinkArguments&&... link)
      : map_(map), bus_(map, time, unit, std::forward<LinkArguments>(link)...), alive_(map) {}

  /// Import is positive. One attempt only: the next check is seconds away, and the battery waits.
  /// kImplausible: another device, a value out of range, or a frozen one.
  Status read(std::int32_t& grid_power_w) {
    // Its address may have passed to another device.
    if (!identified_ || bus_.link().counters().reconnects != identified_connections_) {
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

  /// On kImplausible `failure` has the failed check and its value.
  Status check_identity(IdentityFailure& failure) {
    const Status status = check_identity_of(map_, bus_, failure);
    identified_ = status == Status::kOk;
    identified_connections_ = bus_.link().counters().reconnects;
    return status;
  }

 private:
  const RegisterMap& map_;
  BatteryBus<Link, Time> bus_;
  HeartbeatCheck alive_;
  bool identified_ = false;
  std::int64_t identified_connections_ = 0;
};

/// Time base of the device: in simulation seconds pass faster; it never jumps.
class DeviceTime {
 public:
  explicit DeviceTime(const ScaledClock& clock)
      : clock_(clock), start_ns_(clock_ns(CLOCK_MONOTONIC)) {}

  /// Since construction, never 0.
  [[nodiscard]] std::int64_t now_ns() const {
    return (clock_ns(CLOCK_MONOTONIC) - start_ns_) * clock_.scale + 1;
  }
  void sleep_ms(std::int32_t ms) const {
    const std::int64_t end_ns =
        clock_ns(CLOCK_MONOTONIC) + clock_.wall_ns(std::int64_t{ms} * 1'000'000);
    while (clock_ns(CLOCK_MONOTONIC) < end_ns) sleep_until_monotonic(end_ns);
  }
  [[nodiscard]] std::int64_t utc_day() const {
    return clock_.now_utc_ns() / (kSecondsPerDay * kNanosecondsPerSecond);
  }

 private:
  ScaledClock clock_;
  std::int64_t start_ns_;
};

/// The device's timing, from the map.
inline LinkTiming timing_of(const RegisterMap& map) {
  return {.response_timeout_ms = map.response_timeout_ms,
          .minimum_gap_ms = map.minimum_gap_ms,
          .connect_delay_ms = map.connect_delay_ms};
}

extern template class BatteryDriver<ModbusLink, DeviceTime>;

class ModbusBattery : public BatteryDriver<ModbusLink, DeviceTime> {
 public:
  /// `map` must outlive this object.
  ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
};

// Modbus meter with a link of its own.

extern template class GridMeter<ModbusLink, DeviceTime>;

class ModbusMeter : public GridMeter<ModbusLink, DeviceTime> {
 public:
  /// `map` must outlive this object.
  ModbusMeter(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
};

}  // namespace bess
