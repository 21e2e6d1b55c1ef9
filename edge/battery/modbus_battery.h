// The battery behind a Modbus link: the driver of battery_driver.h over libmodbus, in the time of
// the configured clock.
#pragma once

#include <cstdint>

#include "edge/battery/battery_driver.h"
#include "edge/battery/grid_meter.h"
#include "edge/battery/modbus_link.h"
#include "edge/registers/register_map.h"
#include "shared/scaled_clock.h"

namespace bess {

/// The time that the device lives in: simulated seconds pass faster, and it never jumps.
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
    return clock_.now_utc_ns() / (86'400 * kNanosecondsPerSecond);
  }

 private:
  ScaledClock clock_;
  std::int64_t start_ns_;
};

/// What the map says of the device's timing.
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

// The meter behind a Modbus link of its own: grid_meter.h over libmodbus, in the time of the
// configured clock.

extern template class GridMeter<ModbusLink, DeviceTime>;

class ModbusMeter : public GridMeter<ModbusLink, DeviceTime> {
 public:
  /// `map` must outlive this object.
  ModbusMeter(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
};

}  // namespace bess
