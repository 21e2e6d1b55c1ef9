#include "edge/battery/modbus_battery.h"

namespace bess {

template class BatteryDriver<ModbusLink, DeviceTime>;

ModbusBattery::ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map,
                             const ScaledClock& clock)
    : BatteryDriver(map, DeviceTime(clock), link.unit, link, timing_of(map), clock) {}

}  // namespace bess
