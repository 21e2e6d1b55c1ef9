#include "tools/simulators/battery_sim/bus_reply.h"
#include "shared/host/user_error.h"

#include <modbus/modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace bess {
namespace {

constexpr int kCrcBytes = 2;

Bytes random_bytes(std::mt19937_64& random) {
  Bytes bytes(static_cast<std::size_t>(1 + random() % 40));
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

/// Faults of unit, function, echo or count; `content` begins with the unit.
void change_content(BatteryFault fault, Bytes& content) {
  switch (fault) {
    case BatteryFault::kWrongUnit:
      content[0] ^= 0x40;
      break;
    case BatteryFault::kWrongFunction:
      content[1] = content[1] == 3 ? 4 : 3;
      break;
    case BatteryFault::kWrongAddress:
      content[3] ^= 1;
      break;
    case BatteryFault::kWrongValue:
      content[5] ^= 1;
      break;
    case BatteryFault::kFewerRegisters:
      content[2] = static_cast<std::uint8_t>(content[2] - 2);
      content.resize(content.size() - 2);
      break;
    default:
      break;
  }
}

}  // namespace

BusReply::BusReply(_modbus* context, bool rtu) : context_(context), rtu_(rtu) {
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, tap_) != 0)
    fail("cannot create a socket pair");
}

BusReply::~BusReply() {
  close(tap_[0]);
  close(tap_[1]);
}

Bytes BusReply::answer(const BusRequest& request, _modbus_mapping_t& registers) {
  modbus_set_socket(context_, tap_[0]);
  modbus_reply(context_, request.bytes, request.size, &registers);
  return take();
}

Bytes BusReply::exception(const BusRequest& request, int code) {
  return frame(request, {static_cast<std::uint8_t>(request.unit()),
                         static_cast<std::uint8_t>(request.function() | 0x80),
                         static_cast<std::uint8_t>(code)});
}

Bytes BusReply::spoil(const BusRequest& request, Bytes reply, BatteryFault fault,
                      std::mt19937_64& random) {
  const bool is_exception =
      reply.size() > std::size_t(request.header) + 1 && reply[request.header + 1] >= 0x80;
  switch (fault) {
    case BatteryFault::kWrongUnit:
    case BatteryFault::kWrongFunction:
    case BatteryFault::kWrongAddress:
    case BatteryFault::kWrongValue:
    case BatteryFault::kFewerRegisters: {
      if (is_exception) return reply;  // no content to change
      Bytes content(reply.begin() + request.header, reply.end() - (rtu_ ? kCrcBytes : 0));
      change_content(fault, content);
      return frame(request, content);
    }
    case BatteryFault::kTruncated:
      reply.resize(reply.size() / 2);
      return reply;
    case BatteryFault::kGarbage:
      return random_bytes(random);
    case BatteryFault::kDuplicate:
      reply.resize(2 * reply.size());
      std::copy_n(reply.begin(), reply.size() / 2, reply.begin() + reply.size() / 2);
      return reply;
    case BatteryFault::kWrongTransaction:
      reply[1] ^= 1;
      return reply;
    case BatteryFault::kWrongProtocol:
      reply[3] = 1;
      return reply;
    case BatteryFault::kBadCrc:
      reply.back() ^= 0x10;
      return reply;
    default:
      return reply;
  }
}

/// libmodbus frames any function; over TCP with transaction 0, replaced by that of the request.
Bytes BusReply::frame(const BusRequest& request, const Bytes& unit_and_pdu) {
  modbus_set_socket(context_, tap_[0]);
  modbus_send_raw_request(context_, unit_and_pdu.data(), static_cast<int>(unit_and_pdu.size()));
  Bytes bytes = take();
  if (!rtu_ && bytes.size() >= 2) std::copy_n(request.bytes, 2, bytes.begin());
  return bytes;
}

Bytes BusReply::take() {
  Bytes bytes(600);
  const ssize_t got = recv(tap_[1], bytes.data(), bytes.size(), MSG_DONTWAIT);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

}  // namespace bess
