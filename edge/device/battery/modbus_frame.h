// Modbus frames as pure functions: encodes requests and checks replies. No socket, clock or
// library, so that every check can be tested and fuzzed:
//   TCP  transaction(2) protocol=0(2) length(2) unit(1) | function(1) data
//   RTU                                         unit(1) | function(1) data | CRC(2, low byte first)
// libmodbus 3.1.6 accepts a TCP reply of another unit or protocol, and a write echo with another
// address or value; here all repeated fields are compared with the request.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"

namespace bess {

enum class Framing : std::uint8_t { kTcp, kRtu };

inline constexpr int kFrameBytesMax = 260;      ///< TCP: 7 bytes of header, 253 of PDU
inline constexpr int kReadRegistersMax = 125;   ///< limited by the protocol's one-byte count
inline constexpr int kWriteRegistersMax = 123;  ///< limited by the longest PDU
inline constexpr int kExceptionNoAddress = 2;   ///< 1: illegal function
inline constexpr int kExceptionBusyLong = 5;    ///< acknowledged, still in progress
inline constexpr int kExceptionBusy = 6;        ///< retry later
inline constexpr int kExceptionNoPath = 10;     ///< from a gateway: no path to the device
inline constexpr int kExceptionNoReply = 11;    ///< from a gateway: no response of the device
inline constexpr int kExceptionDenied = 0x80;   ///< vendors' "permission denied"

struct ModbusRequest {
  std::int32_t unit = 1;
  std::uint8_t function = 3;  ///< 3 and 4 read, 6 and 16 write
  std::uint16_t address = 0;  ///< PDU address, 0-based
  int count = 1;
  const std::uint16_t* values = nullptr;  ///< of a write
  std::uint16_t transaction = 0;          ///< TCP only: identifies the reply

  [[nodiscard]] bool is_write() const { return function == 6 || function == 16; }
  /// True if the protocol can carry it; others must not be sent.
  [[nodiscard]] bool is_valid() const;
};

struct ModbusFrame {
  std::uint8_t bytes[kFrameBytesMax] = {};
  int size = 0;
};

void build_request(Framing framing, const ModbusRequest& request, ModbusFrame& frame);

/// Size of the longest reply that fits the request.
int reply_bytes_max(Framing framing, const ModbusRequest& request);

/// Number of bytes still to receive: 0 = complete, -1 = not a reply to the request. Never more than
/// a frame can hold.
int missing_bytes(Framing framing, const ModbusRequest& request, const ModbusFrame& reply);

struct ReplyCheck {
  Status status = Status::kBadReply;
  int exception = 0;      ///< exception code of the device, 0 = none
  int foreign_unit = -1;  ///< unit that answered instead of the addressed one; -1 = none
};

/// TCP: a late reply to an earlier request of this or another connection.
bool is_stale(const ModbusRequest& request, const ModbusFrame& reply);

/// Compares a complete reply with its request; `registers` of a read are filled only on kOk.
ReplyCheck check_reply(Framing framing, const ModbusRequest& request, const ModbusFrame& reply,
                       std::uint16_t* registers);

/// Default meaning of an exception code: 1 to 4 concern the request, others are temporary.
constexpr Status status_of_exception(int code) {
  if (code == kExceptionBusyLong || code == kExceptionBusy || code == kExceptionNoPath ||
      code == kExceptionNoReply) {
    return Status::kBusBusy;
  }
  return code == kExceptionDenied ? Status::kNotPermitted : Status::kBusException;
}

}  // namespace bess
