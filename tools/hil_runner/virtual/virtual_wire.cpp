// ModbusWire of the edge on the virtual bus of its port; linked instead of
// edge/device/battery/modbus_wire.cpp.
#include "edge/device/battery/modbus_wire.h"

#include "tools/hil_runner/virtual/virtual_bus.h"

namespace bess {
namespace {

/// Stored in place of libmodbus' context; null: no bus at that port.
_modbus* kept(VirtualBus* bus) { return reinterpret_cast<_modbus*>(bus); }
VirtualBus& bus_of(_modbus* context) { return *reinterpret_cast<VirtualBus*>(context); }

}  // namespace

ModbusWire::ModbusWire(const BatteryLinkSettings& settings, std::int32_t)
    : rtu_(settings.rtu), context_(kept(VirtualBus::at(settings.port))) {}

ModbusWire::~ModbusWire() { close(); }

Status ModbusWire::open() {
  if (context_ == nullptr) return Status::kNotConnected;
  const Status status = bus_of(context_).open();
  if (status == Status::kOk) fd_ = 0;
  return status;
}

void ModbusWire::close() {
  if (fd_ < 0) return;
  bus_of(context_).close();
  fd_ = -1;
}

bool ModbusWire::is_lost() const { return bus_of(context_).is_lost(); }

void ModbusWire::discard_input() { bus_of(context_).discard_input(); }

Status ModbusWire::send(const ModbusFrame& frame) { return bus_of(context_).send(frame); }

Status ModbusWire::receive(int count, std::int64_t deadline_monotonic_ns, ModbusFrame& frame) {
  return bus_of(context_).receive(count, deadline_monotonic_ns, frame);
}

}  // namespace bess
