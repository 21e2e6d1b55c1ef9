// The edge's ModbusWire, by the same header, with a virtual bus at its other end: linked instead of
// edge/battery/modbus_wire.cpp.
#include "edge/battery/modbus_wire.h"

#include "tools/hil_runner/virtual_bus.h"

namespace bess {

ModbusWire::ModbusWire(const BatteryLinkSettings& settings, std::int32_t)
    : rtu_(settings.rtu), context_(nullptr) {}

ModbusWire::~ModbusWire() { close(); }

Status ModbusWire::open() {
  const Status status = VirtualBus::current().open();
  if (status == Status::kOk) fd_ = 0;
  return status;
}

void ModbusWire::close() {
  if (fd_ < 0) return;
  VirtualBus::current().close();
  fd_ = -1;
}

bool ModbusWire::is_spoilt() const { return VirtualBus::current().is_spoilt(); }

void ModbusWire::discard_input() { VirtualBus::current().discard_input(); }

Status ModbusWire::send(const ModbusFrame& frame) { return VirtualBus::current().send(frame); }

Status ModbusWire::receive(int count, std::int64_t deadline_monotonic_ns, ModbusFrame& frame) {
  return VirtualBus::current().receive(count, deadline_monotonic_ns, frame);
}

}  // namespace bess
