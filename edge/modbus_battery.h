// The battery behind Modbus TCP or RTU, driven through a register map. The only edge file pair that
// knows libmodbus. Own connection state machine, because the library's recovery blocks for ever
// when nobody listens, and because on RTU a late reply would be taken for the answer to the next
// question:
//   TCP: close and connect again after any error      RTU: wait out the reply, flush, then go on
// One context, created once; afterwards nothing here allocates (modbus_new_* is the only malloc).
#pragma once

#include <cstdint>

#include "edge/control_types.h"
#include "edge/registers/codec.h"
#include "edge/registers/register_map.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"
#include "shared/status.h"

struct _modbus;

namespace bess {

struct BatteryLinkSettings {
  bool rtu = false;
  FixedText<63> host = "127.0.0.1";  ///< numeric IPv4: names would need the resolver
  std::int32_t port = 502;
  FixedText<127> device = "/dev/ttyUSB0";
  std::int32_t baud = 9'600;
  std::int32_t unit = -1;                 ///< -1 = the map's
  std::int32_t response_timeout_ms = -1;  ///< wall time; -1 = the map's
};

struct IdentityFailure {
  int check = 0;  ///< index into RegisterMap::identity
  std::int64_t value = 0;
};

class ModbusBattery {
 public:
  /// `map` must outlive this object.
  ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
  ModbusBattery(const ModbusBattery&) = delete;
  ModbusBattery& operator=(const ModbusBattery&) = delete;
  ~ModbusBattery();

  /// Connects if needed and reads everything that the map measures.
  Status read(BatteryMeasurement& measurement);
  /// Writes an order and reads it back.
  Status order(const PowerOrder& order);
  /// Gives the battery back to its own mode and reads that back.
  Status release();
  /// Reads the map's identity checks; on kImplausible `failure` says which one and what was read.
  /// `read` fails until this has succeeded once, so nothing is ever ordered of an unknown device.
  Status check_identity(IdentityFailure& failure);

  void close();

 private:
  /// Registers that one request reads; derived from the points to be read.
  struct ReadSpan {
    std::uint16_t address = 0;
    std::uint16_t count = 0;
    std::uint8_t function = 3;
  };
  static constexpr int kSpanRegistersMax = 120;

  void plan_reads();
  Status connect();
  Status run_command(Command command, const PowerOrder& order);
  Status run_command_once(Command command, const PowerOrder& order);
  Status verify_command(const CommandSequence& sequence, const PowerOrder& order);
  Status write_block(const BlockWrite& write, const RegisterBlock& block);
  Status read_registers(const ReadSpan& span, std::uint16_t* registers);
  Status read_point(int point, std::int64_t& value);
  Status read_span_values(const ReadSpan& span, BatteryMeasurement& measurement);
  void store(int point, std::int64_t value, BatteryMeasurement& measurement) const;
  void wait_for_gap();
  Status finish_request(bool succeeded);
  void recover();

  BatteryLinkSettings link_;
  const RegisterMap& map_;
  ScaledClock clock_;
  std::int32_t response_timeout_ms_;
  _modbus* context_ = nullptr;
  bool connected_ = false;
  bool identified_ = false;
  std::int64_t next_request_ns_ = 0;  ///< CLOCK_MONOTONIC; keeps the device's minimum gap
  StaticVector<ReadSpan, 16> spans_;

  // Points with a meaning for the controller, by name; -1 = not in this map.
  int soc_, power_, capacity_, charge_limit_, discharge_limit_, temperature_min_, temperature_max_;
};

}  // namespace bess
