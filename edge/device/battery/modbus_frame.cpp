#include "edge/device/battery/modbus_frame.h"

namespace bess {
namespace {

constexpr int kTcpHeaderBytes = 6;  ///< including the length field, which counts the rest
constexpr int kCrcBytes = 2;
constexpr int kUnitBytes = 1;
constexpr int kExceptionPduBytes = 2;
constexpr int kWriteReplyPduBytes = 5;
constexpr int kTcpLengthMin = 3;  ///< unit, function, one byte of data
constexpr int kTcpLengthMax = 254;
constexpr std::uint8_t kExceptionFlag = 0x80;

int word_at(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

void put_byte(ModbusFrame& frame, int value) {
  frame.bytes[frame.size++] = static_cast<std::uint8_t>(value);
}

void put_word(ModbusFrame& frame, int value) {
  put_byte(frame, value >> 8);
  put_byte(frame, value & 0xFF);
}

/// Modbus over serial line V1.02, 6.2.2: polynomial 0xA001 reflected, start 0xFFFF.
int crc16(const std::uint8_t* bytes, int size) {
  unsigned crc = 0xFFFF;
  for (int i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
  }
  return static_cast<int>(crc);
}

int request_pdu_size(const ModbusRequest& request) {
  return request.function == 16 ? 6 + 2 * request.count : 5;
}

int reply_pdu_size(const ModbusRequest& request) {
  return request.is_write() ? kWriteReplyPduBytes : 2 + 2 * request.count;
}

void put_pdu(const ModbusRequest& request, ModbusFrame& frame) {
  put_byte(frame, request.function);
  put_word(frame, request.address);
  put_word(frame, request.function == 6 ? request.values[0] : request.count);
  if (request.function != 16) return;
  put_byte(frame, 2 * request.count);
  for (int i = 0; i < request.count; ++i) put_word(frame, request.values[i]);
}

/// Some gateways answer with their own unit id; the transaction id still identifies the reply.
bool is_unit_of_gateway(int unit) { return unit == 0 || unit == 255; }

ReplyCheck check_pdu(const ModbusRequest& request, const std::uint8_t* pdu, int size,
                     std::uint16_t* registers) {
  if (pdu[0] == (request.function | kExceptionFlag) && size == kExceptionPduBytes) {
    return {status_of_exception(pdu[1]), pdu[1]};
  }
  if (pdu[0] != request.function || size != reply_pdu_size(request)) return {};
  if (request.is_write()) {
    const int echoed = request.function == 6 ? request.values[0] : request.count;
    const bool fits = word_at(pdu + 1) == request.address && word_at(pdu + 3) == echoed;
    return {fits ? Status::kOk : Status::kBadReply};
  }
  if (pdu[1] != 2 * request.count) return {};
  for (int i = 0; i < request.count; ++i) {
    registers[i] = static_cast<std::uint16_t>(word_at(pdu + 2 + 2 * i));
  }
  return {Status::kOk};
}

}  // namespace

bool ModbusRequest::is_valid() const {
  const bool known = function == 3 || function == 4 || is_write();
  const int count_max = function == 6 ? 1 : is_write() ? kWriteRegistersMax : kReadRegistersMax;
  return known && unit >= 0 && unit <= 255 && count >= 1 && count <= count_max &&
         address + count <= 0x1'0000;
}

void build_request(Framing framing, const ModbusRequest& request, ModbusFrame& frame) {
  frame.size = 0;
  if (framing == Framing::kTcp) {
    put_word(frame, request.transaction);
    put_word(frame, 0);
    put_word(frame, kUnitBytes + request_pdu_size(request));
  }
  put_byte(frame, request.unit);
  put_pdu(request, frame);
  if (framing == Framing::kRtu) {
    const int crc = crc16(frame.bytes, frame.size);
    put_byte(frame, crc & 0xFF);
    put_byte(frame, crc >> 8);
  }
}

int reply_bytes_max(Framing framing, const ModbusRequest& request) {
  const int around = framing == Framing::kTcp ? kTcpHeaderBytes : kCrcBytes;
  return around + kUnitBytes + reply_pdu_size(request);
}

int missing_bytes(Framing framing, const ModbusRequest& request, const ModbusFrame& reply) {
  if (framing == Framing::kTcp) {
    if (reply.size < kTcpHeaderBytes) return kTcpHeaderBytes - reply.size;
    const int length = word_at(reply.bytes + 4);
    if (length < kTcpLengthMin || length > kTcpLengthMax) return -1;
    return kTcpHeaderBytes + length - reply.size;
  }
  constexpr int kShortestReply = kUnitBytes + kExceptionPduBytes + kCrcBytes;
  if (reply.size < kShortestReply) return kShortestReply - reply.size;
  if (reply.bytes[1] == (request.function | kExceptionFlag)) return kShortestReply - reply.size;
  if (reply.bytes[1] != request.function) return -1;
  return reply_bytes_max(framing, request) - reply.size;
}

bool is_stale(const ModbusRequest& request, const ModbusFrame& reply) {
  return word_at(reply.bytes) != request.transaction;
}

ReplyCheck check_reply(Framing framing, const ModbusRequest& request, const ModbusFrame& reply,
                       std::uint16_t* registers) {
  if (missing_bytes(framing, request, reply) != 0) return {};
  const bool tcp = framing == Framing::kTcp;
  const std::uint8_t* unit = reply.bytes + (tcp ? kTcpHeaderBytes : 0);
  const int pdu_size =
      static_cast<int>(reply.bytes + reply.size - unit) - kUnitBytes - (tcp ? 0 : kCrcBytes);
  const bool is_of_unit = *unit == request.unit || (tcp && is_unit_of_gateway(*unit));
  if (!is_of_unit) return {.foreign_unit = *unit};
  if (tcp) {
    if (is_stale(request, reply) || word_at(reply.bytes + 2) != 0) return {};
  } else {
    const std::uint8_t* crc = reply.bytes + reply.size - kCrcBytes;
    if (crc16(reply.bytes, reply.size - kCrcBytes) != (crc[1] << 8 | crc[0])) return {};
  }
  return check_pdu(request, unit + kUnitBytes, pdu_size, registers);
}

}  // namespace bess
