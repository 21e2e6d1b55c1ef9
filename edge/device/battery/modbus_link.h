// Modbus link: one connection, TCP or RTU, with request deadlines, the device's minimum gap, and
// error recovery. Its parts:
//   link_state (what may happen now)    modbus_frame (bytes of a request, is this its reply)
//   modbus_wire (socket or serial line) unanswered_requests (RTU: which replies may still come)
// After an error that is not an exception of the device:
//   TCP: close; the next request reconnects, so that a late reply cannot arrive
//   RTU: wait for a silent line, discard the input, and send no request for which a late reply
//        could be mistaken
// A request ends within connect time-out + connect delay + quiet + gap + response time-out (RTU:
// plus the frames' time on the line; plus `late_reply_ms_max` if a late reply could be mistaken),
// whatever the device sends. No allocation after the constructor.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/core/control/control_types.h"
#include "edge/device/battery/link_state.h"
#include "edge/device/battery/modbus_frame.h"
#include "edge/device/battery/modbus_wire.h"
#include "edge/device/battery/unanswered_requests.h"
#include "shared/bus_exchange.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Time that the device needs between requests, from its register map.
struct LinkTiming {
  std::int32_t response_timeout_ms = 1'000;  ///< wall time, also for connecting
  std::int32_t minimum_gap_ms = 0;           ///< from the end of a request to the next, in `clock`
  std::int32_t connect_delay_ms = 0;         ///< from connecting to the first request, in `clock`
  // RTU, in `clock`; raised to at least one (quiet) and five (late reply) response time-outs:
  std::int32_t quiet_ms = 1'000;            ///< after a failed request, before the next
  std::int32_t late_reply_ms_max = 10'000;  ///< maximum delay of a reply
};

/// Contiguous registers of one unit, read by one request.
struct RegisterSpan {
  std::int32_t unit = 1;
  std::uint16_t address = 0;  ///< PDU address, 0-based
  std::uint16_t count = 0;
  std::uint8_t function = 3;  ///< 3 holding, 4 input
};

/// Observer of every request and its result, on the requesting thread: it must neither wait nor
/// allocate. It takes the time of an exchange itself.
struct ExchangeListener {
  void (*on_exchange)(void* owner, const BusExchange& exchange) = nullptr;
  void* owner = nullptr;
};

class ModbusLink {
 public:
  ModbusLink(const BatteryLinkSettings& settings, const LinkTiming& timing,
             const ScaledClock& clock);

  /// Connects if needed. `registers` holds at least `span.count`; filled only on kOk.
  Status read(const RegisterSpan& span, std::uint16_t* registers);
  /// `function` 6 writes only the first register, 16 writes `count` in one request. Nothing is sent
  /// after `send_until_ns` (CLOCK_MONOTONIC), e.g. after connecting and the device's gap: kTooLate.
  Status write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
               const std::uint16_t* registers, int count, std::int64_t send_until_ns = INT64_MAX);
  void close();
  void set_exchange_listener(const ExchangeListener& listener) { listener_ = listener; }

  /// Exception code of the last request, 0 without one: for register maps with vendor-specific
  /// codes.
  [[nodiscard]] int last_exception() const { return last_exception_; }
  /// Unit that answered the last request instead of the addressed one; -1: none.
  [[nodiscard]] int foreign_unit() const { return foreign_unit_; }
  [[nodiscard]] int asked_unit() const { return asked_unit_; }
  /// Without those of orders and flash registers.
  [[nodiscard]] const BatteryCounters& counters() const { return counters_; }

 private:
  Status request(ModbusRequest request, std::uint16_t* registers, std::int64_t send_until_ns);
  Status make_ready(const ModbusRequest& request);
  Status connect();
  Status ask(const ModbusRequest& request, std::uint16_t* registers, std::int64_t send_until_ns);
  Status receive_reply(const ModbusRequest& request, std::int64_t deadline_ns, ModbusFrame& reply);
  void finish(const ModbusRequest& request, Status status);
  void report_exchange(const ModbusRequest& request, const std::uint16_t* registers, Status status,
                       std::int64_t asked_ns) const;
  [[nodiscard]] std::int64_t line_time_ns(int bytes) const;

  bool rtu_;
  Framing framing_;
  std::int32_t baud_;
  LinkTiming timing_;
  ModbusWire wire_;
  LinkStateMachine state_;
  UnansweredRequests unanswered_;
  BatteryCounters counters_;
  Status connect_status_ = Status::kNotConnected;  ///< of the last attempt to connect
  bool was_connected_ = false;
  int last_exception_ = 0;
  int foreign_unit_ = -1;
  int asked_unit_ = 0;
  std::uint16_t transaction_ = 0;
  std::int64_t sent_ns_ = 0;
  ExchangeListener listener_;
};

}  // namespace bess
