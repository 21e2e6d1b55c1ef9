// Bytes of an answer. libmodbus makes every frame, as an independent check of the edge's framing;
// faults then change it. libmodbus writes into a socket pair instead of the client's connection,
// and the frame is read from its other end.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tools/simulators/battery_sim/battery_faults.h"

struct _modbus;
struct _modbus_mapping_t;

namespace bess {

using Bytes = std::vector<std::uint8_t>;

inline constexpr int kTcpHeaderBytes = 6;  ///< before the unit; RTU has none

/// A request as libmodbus received it, header included.
struct BusRequest {
  std::uint8_t bytes[260];
  int size = 0;
  int header = 0;

  [[nodiscard]] int unit() const { return bytes[header]; }
  [[nodiscard]] int function() const { return bytes[header + 1]; }
  /// 16 bits at an offset from the unit.
  [[nodiscard]] int word(int offset) const {
    return bytes[header + offset] << 8 | bytes[header + offset + 1];
  }
  [[nodiscard]] int address() const { return word(2); }
  [[nodiscard]] bool is_write() const { return function() == 6 || function() == 16; }
  [[nodiscard]] int write_count() const { return function() == 16 ? word(4) : 1; }
};

class BusReply {
 public:
  BusReply(_modbus* context, bool rtu);
  BusReply(const BusReply&) = delete;
  BusReply& operator=(const BusReply&) = delete;
  ~BusReply();

  /// Correct answer; a write changes `registers`.
  Bytes answer(const BusRequest& request, _modbus_mapping_t& registers);
  Bytes exception(const BusRequest& request, int code);
  /// Frame of any answer, from unit and PDU.
  Bytes frame(const BusRequest& request, const Bytes& unit_and_pdu);
  /// Changes a correct answer by a fault of its bytes; other faults have no effect.
  Bytes spoil(const BusRequest& request, Bytes reply, BatteryFault fault, std::mt19937_64& random);

 private:
  Bytes take();

  _modbus* context_;
  bool rtu_;
  int tap_[2] = {-1, -1};
};

}  // namespace bess
