// One Modbus connection, TCP or RTU: requests with a deadline, the device's minimum gap, and what is
// done after an error. The only edge file pair that knows libmodbus. Own connection state machine,
// because the library's recovery blocks for ever when nobody listens, and because on RTU a late
// reply would be taken for the answer to the next question:
//   TCP: close and connect again after any error      RTU: wait out the reply, flush, then go on
// One context, created once; afterwards nothing here allocates (modbus_new_* is the only malloc).
#pragma once

#include <cstdint>

#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"
#include "shared/status.h"

struct _modbus;

namespace bess {

/// Where the battery is, by the operator's configuration.
struct BatteryLinkSettings {
  bool rtu = false;
  FixedText<63> host = "127.0.0.1";  ///< numeric IPv4: names would need the resolver
  std::int32_t port = 502;
  FixedText<127> device = "/dev/ttyUSB0";
  std::int32_t baud = 9'600;
  std::int32_t unit = -1;                 ///< -1 = the map's
  std::int32_t response_timeout_ms = -1;  ///< wall time; -1 = the map's
};

/// What the device needs between requests, by its register map.
struct LinkTiming {
  std::int32_t response_timeout_ms = 1'000;  ///< wall time
  std::int32_t minimum_gap_ms = 0;           ///< from the end of a request to the next, in `clock`
};

/// Contiguous registers of one unit that one request reads.
struct RegisterSpan {
  std::int32_t unit = 1;
  std::uint16_t address = 0;  ///< PDU address, 0-based
  std::uint16_t count = 0;
  std::uint8_t function = 3;  ///< 3 holding, 4 input
};

class ModbusLink {
 public:
  ModbusLink(const BatteryLinkSettings& settings, const LinkTiming& timing,
             const ScaledClock& clock);
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;
  ~ModbusLink();

  /// Connects if needed. `registers` holds at least `span.count`.
  Status read(const RegisterSpan& span, std::uint16_t* registers);
  /// `function` 6 writes the first register alone, 16 writes `count` of them at once.
  Status write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
               const std::uint16_t* registers, int count);
  void close();

 private:
  Status connect();
  Status begin_request(std::int32_t unit);
  Status finish_request(bool succeeded);
  void wait_for_gap() const;
  void recover();

  bool rtu_;
  LinkTiming timing_;
  ScaledClock clock_;
  _modbus* context_ = nullptr;
  bool connected_ = false;
  std::int64_t next_request_ns_ = 0;  ///< CLOCK_MONOTONIC; keeps the device's minimum gap
};

}  // namespace bess
