#include "edge/device/battery/modbus_battery.h"

namespace bess {

template class GridMeter<ModbusLink, DeviceTime>;

ModbusMeter::ModbusMeter(const BatteryLinkSettings& link, const RegisterMap& map,
                         const ScaledClock& clock)
    : GridMeter(map, DeviceTime(clock), link.unit, link, timing_of(map), clock) {}

template class BatteryDriver<ModbusLink, DeviceTime>;

ModbusBattery::ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map,
                             const ScaledClock& clock)
    : BatteryDriver(map, DeviceTime(clock), link.unit, link, timing_of(map), clock) {}

}  // namespace bess
