#include "edge/battery/modbus_meter.h"

namespace bess {

template class GridMeter<ModbusLink, DeviceTime>;

ModbusMeter::ModbusMeter(const BatteryLinkSettings& link, const RegisterMap& map,
                         const ScaledClock& clock)
    : GridMeter(map, DeviceTime(clock), link.unit, link, timing_of(map), clock) {}

}  // namespace bess
