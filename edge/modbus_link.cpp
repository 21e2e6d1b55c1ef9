#include "edge/modbus_link.h"

#include <modbus/modbus.h>

#include <algorithm>
#include <cerrno>

#include "shared/check.h"

namespace bess {
namespace {

Status status_of_errno(int error) {
  switch (error) {
    case ETIMEDOUT:
    case EINPROGRESS:  // what libmodbus 3.1.6 leaves when connecting times out
      return Status::kTimeout;
    case EMBXILFUN:
    case EMBXILADD:
    case EMBXILVAL:
    case EMBXSFAIL:
    case EMBXNACK:
    case EMBXMEMPAR:
    case EMBXGPATH:
    case EMBXGTAR:
      return Status::kBusException;
    case EMBXACK:
    case EMBXSBUSY:
      return Status::kBusBusy;
    case EMBBADCRC:
    case EMBBADDATA:
    case EMBBADEXC:
    case EMBUNKEXC:
    case EMBMDATA:
    case EMBBADSLAVE:
      return Status::kBadReply;
    default:
      return Status::kNotConnected;
  }
}

}  // namespace

ModbusLink::ModbusLink(const BatteryLinkSettings& settings, const LinkTiming& timing,
                       const ScaledClock& clock)
    : rtu_(settings.rtu), timing_(timing), clock_(clock) {
  context_ = rtu_ ? modbus_new_rtu(settings.device.c_str(), settings.baud, 'N', 8, 1)
                  : modbus_new_tcp(settings.host.c_str(), settings.port);
  BESS_CHECK(context_ != nullptr);
  if (settings.response_timeout_ms > 0) timing_.response_timeout_ms = settings.response_timeout_ms;
  const auto seconds = static_cast<std::uint32_t>(timing_.response_timeout_ms / 1'000);
  const auto microseconds = static_cast<std::uint32_t>(timing_.response_timeout_ms % 1'000 * 1'000);
  modbus_set_error_recovery(context_, MODBUS_ERROR_RECOVERY_NONE);
  modbus_set_response_timeout(context_, seconds, microseconds);
  modbus_set_byte_timeout(context_, seconds, microseconds);
}

ModbusLink::~ModbusLink() {
  close();
  modbus_free(context_);
}

void ModbusLink::close() {
  if (connected_) modbus_close(context_);
  connected_ = false;
}

Status ModbusLink::connect() {
  if (connected_) return Status::kOk;
  if (modbus_connect(context_) != 0) {
    const Status status = status_of_errno(errno);
    modbus_close(context_);  // a failed connect may leave a socket behind
    return status;
  }
  connected_ = true;
  return Status::kOk;
}

/// The device's minimum gap runs in simulated time, like everything that the battery itself times.
void ModbusLink::wait_for_gap() const {
  while (clock_ns(CLOCK_MONOTONIC) < next_request_ns_) sleep_until_monotonic(next_request_ns_);
}

Status ModbusLink::begin_request(std::int32_t unit) {
  if (const Status status = connect(); status != Status::kOk) return status;
  modbus_set_slave(context_, unit);
  wait_for_gap();
  return Status::kOk;
}

Status ModbusLink::finish_request(bool succeeded) {
  const int error = errno;
  next_request_ns_ =
      clock_ns(CLOCK_MONOTONIC) + clock_.wall_ns(std::int64_t{timing_.minimum_gap_ms} * 1'000'000);
  if (succeeded) return Status::kOk;
  const Status status = status_of_errno(error);
  recover();
  return status;
}

void ModbusLink::recover() {
  if (!rtu_) return close();
  // RTU has no transaction id: a late reply must have come and gone before the next question.
  const std::int64_t quiet_ns =
      std::int64_t{std::max(timing_.response_timeout_ms, 1'000)} * 1'000'000;
  const std::int64_t until_ns = clock_ns(CLOCK_MONOTONIC) + quiet_ns;
  while (clock_ns(CLOCK_MONOTONIC) < until_ns) sleep_until_monotonic(until_ns);
  if (modbus_flush(context_) < 0) close();
}

Status ModbusLink::read(const RegisterSpan& span, std::uint16_t* registers) {
  if (const Status status = begin_request(span.unit); status != Status::kOk) return status;
  const int got = span.function == 4
                      ? modbus_read_input_registers(context_, span.address, span.count, registers)
                      : modbus_read_registers(context_, span.address, span.count, registers);
  return finish_request(got == span.count);
}

Status ModbusLink::write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
                         const std::uint16_t* registers, int count) {
  if (const Status status = begin_request(unit); status != Status::kOk) return status;
  const int sent = function == 6 ? modbus_write_register(context_, address, registers[0])
                                 : modbus_write_registers(context_, address, count, registers);
  return finish_request(sent == count);
}

}  // namespace bess
