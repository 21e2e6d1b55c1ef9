// Modbus frames as pure functions: the bytes of a request, and whether some bytes are its reply. No
// socket, no clock, no library, so that every check can be tested and fuzzed on its own:
//   TCP  transaction(2) protocol=0(2) length(2) unit(1) | function(1) data
//   RTU                                         unit(1) | function(1) data | CRC(2, low byte first)
// libmodbus 3.1.6 would take a TCP reply of another unit or protocol, and a write's echo of another
// address or value, for good; here a reply is compared with its request in everything it repeats.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"

namespace bess {

enum class Framing : std::uint8_t { kTcp, kRtu };

inline constexpr int kFrameBytesMax = 260;      ///< TCP: 7 bytes of header, 253 of PDU
inline constexpr int kReadRegistersMax = 125;   ///< by the protocol's one-byte count
inline constexpr int kWriteRegistersMax = 123;  ///< by the longest PDU
inline constexpr int kExceptionNoAddress = 2;   ///< 1: no such function
inline constexpr int kExceptionBusyLong = 5;    ///< acknowledged, still at work
inline constexpr int kExceptionBusy = 6;        ///< ask again later
inline constexpr int kExceptionNoPath = 10;     ///< of a gateway: the way to the device is blocked
inline constexpr int kExceptionNoReply = 11;    ///< of a gateway: the device did not answer it
inline constexpr int kExceptionDenied = 0x80;   ///< vendors' "permission denied"

struct ModbusRequest {
  std::int32_t unit = 1;
  std::uint8_t function = 3;  ///< 3 and 4 read, 6 and 16 write
  std::uint16_t address = 0;  ///< PDU address, 0-based
  int count = 1;
  const std::uint16_t* values = nullptr;  ///< of a write
  std::uint16_t transaction = 0;          ///< TCP only: tells one reply from another

  [[nodiscard]] bool is_write() const { return function == 6 || function == 16; }
  /// What the protocol can carry; anything else must not be sent.
  [[nodiscard]] bool is_valid() const;
};

struct ModbusFrame {
  std::uint8_t bytes[kFrameBytesMax] = {};
  int size = 0;
};

void build_request(Framing framing, const ModbusRequest& request, ModbusFrame& frame);

/// Size of the longest reply that fits the request.
int reply_bytes_max(Framing framing, const ModbusRequest& request);

/// How many bytes to wait for before asking again: 0 = the reply is complete, -1 = whatever
/// follows, this is no reply to the request. Never asks for more than a frame can hold.
int missing_bytes(Framing framing, const ModbusRequest& request, const ModbusFrame& reply);

struct ReplyCheck {
  Status status = Status::kBadReply;
  int exception = 0;      ///< the exception code that the device answered, 0 = none
  int foreign_unit = -1;  ///< the unit that answered instead of the one that was asked; -1 = none
};

/// TCP: an answer to an earlier request of this or another connection, which came too late.
bool is_stale(const ModbusRequest& request, const ModbusFrame& reply);

/// Compares a complete reply with its request; `registers` of a read are filled only on kOk.
ReplyCheck check_reply(Framing framing, const ModbusRequest& request, const ModbusFrame& reply,
                       std::uint16_t* registers);

/// What an exception code means when the register map says nothing else: 1 to 4 concern the
/// request, the rest passes.
constexpr Status status_of_exception(int code) {
  if (code == kExceptionBusyLong || code == kExceptionBusy || code == kExceptionNoPath ||
      code == kExceptionNoReply) {
    return Status::kBusBusy;
  }
  return code == kExceptionDenied ? Status::kNotPermitted : Status::kBusException;
}

}  // namespace bess
