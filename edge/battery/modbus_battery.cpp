#include "edge/battery/modbus_battery.h"

namespace bess {

template class BatteryDriver<ModbusLink, DeviceTime>;

ModbusBattery::ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map,
                             const ScaledClock& clock)
    : BatteryDriver(map, DeviceTime(clock), link.unit, link,
                    LinkTiming{.response_timeout_ms = map.response_timeout_ms,
                               .minimum_gap_ms = map.minimum_gap_ms,
                               .connect_delay_ms = map.connect_delay_ms},
                    clock) {}

}  // namespace bess
