// The meter behind a Modbus link of its own: grid_meter.h over libmodbus, in the time of the
// configured clock.
#pragma once

#include "edge/battery/grid_meter.h"
#include "edge/battery/modbus_battery.h"

namespace bess {

extern template class GridMeter<ModbusLink, DeviceTime>;

class ModbusMeter : public GridMeter<ModbusLink, DeviceTime> {
 public:
  /// `map` must outlive this object.
  ModbusMeter(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
};

}  // namespace bess
