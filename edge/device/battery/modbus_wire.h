// Modbus wire: bytes of one connection. libmodbus opens, configures and closes it (TCP socket or
// serial line). Whole chunks are sent and received here with an absolute deadline, because
// libmodbus restarts its receive time-out for each group of bytes: a slow device could block it for
// minutes. The only edge file pair that uses libmodbus. One context, created once; no allocation
// afterwards (modbus_new_* is the library's only malloc).
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/device/battery/modbus_frame.h"
#include "edge/device/registers/register_point.h"
#include "shared/fixed_text.h"

struct _modbus;

namespace bess {

/// Address of the battery, from the operator's configuration.
struct BatteryLinkSettings {
  bool rtu = false;
  FixedText<63> host = "127.0.0.1";  ///< numeric IPv4: names would need the resolver
  std::int32_t port = 502;
  FixedText<127> device = "/dev/ttyUSB0";
  std::int32_t baud = 9'600;
  Parity parity = Parity::kNone;
  std::int32_t stop_bits = 1;
  std::int32_t unit = -1;                 ///< -1 = the map's
  std::int32_t response_timeout_ms = -1;  ///< wall time; -1 = the map's
};

/// Speeds that libmodbus supports on Linux; others silently become 9600.
constexpr bool is_serial_speed(std::int32_t baud) {
  for (const std::int32_t known :
       {1'200, 2'400, 4'800, 9'600, 19'200, 38'400, 57'600, 115'200, 230'400}) {
    if (baud == known) return true;
  }
  return false;
}

class ModbusWire {
 public:
  ModbusWire(const BatteryLinkSettings& settings, std::int32_t connect_timeout_ms);
  ModbusWire(const ModbusWire&) = delete;
  ModbusWire& operator=(const ModbusWire&) = delete;
  ~ModbusWire();

  Status open();
  void close();
  /// The peer has closed. TCP: unsolicited input (a late reply) is discarded.
  [[nodiscard]] bool is_lost() const;
  /// Serial line: discards unread input.
  void discard_input();

  Status send(const ModbusFrame& frame);
  /// Appends 1 to `count` bytes as soon as any are available.
  Status receive(int count, std::int64_t deadline_monotonic_ns, ModbusFrame& frame);

 private:
  bool rtu_;
  _modbus* context_;
  int fd_ = -1;
};

}  // namespace bess
