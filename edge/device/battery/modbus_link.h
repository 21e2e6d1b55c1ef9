// One Modbus connection, TCP or RTU: a request with a deadline, the device's minimum gap, and what
// is done after an error. Between the parts that know one thing each:
//   link_state (what may happen now)    modbus_frame (bytes of a request, is this its reply)
//   modbus_wire (socket or serial line) unanswered_requests (RTU: whose reply may still come)
// After an error that is not an exception of the device:
//   TCP: close; the next request connects again, so a late reply has no way to arrive
//   RTU: wait until the line has been quiet, forget what came, and never ask what a late reply
//        could be taken for the answer to
// A request ends within connect time-out + connect delay + quiet + gap + response time-out (RTU:
// plus the frames' time on the line; plus `late_reply_ms_max` where a late reply could be
// mistaken), whatever the device sends, byte by byte or not at all. Nothing here allocates after
// the constructor.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/device/battery/link_state.h"
#include "edge/device/battery/modbus_frame.h"
#include "edge/device/battery/modbus_wire.h"
#include "edge/device/battery/unanswered_requests.h"
#include "shared/bus_exchange.h"
#include "shared/scaled_clock.h"

namespace bess {

/// What the device needs between requests, by its register map.
struct LinkTiming {
  std::int32_t response_timeout_ms = 1'000;  ///< wall time, also of connecting
  std::int32_t minimum_gap_ms = 0;           ///< from the end of a request to the next, in `clock`
  std::int32_t connect_delay_ms = 0;         ///< from connecting to the first request, in `clock`
  // RTU, in `clock`, and at least 1 and 5 response time-outs:
  std::int32_t quiet_ms = 1'000;            ///< after a failed request, before the next
  std::int32_t late_reply_ms_max = 10'000;  ///< no reply comes later than this
};

/// Contiguous registers of one unit that one request reads.
struct RegisterSpan {
  std::int32_t unit = 1;
  std::uint16_t address = 0;  ///< PDU address, 0-based
  std::uint16_t count = 0;
  std::uint8_t function = 3;  ///< 3 holding, 4 input
};

/// Since start.
struct LinkCounters {
  std::int64_t requests = 0;         ///< sent, or not because nothing was connected
  std::int64_t failed_requests = 0;  ///< of those, without a good reply
  std::int64_t reconnects = 0;       ///< connections after the first
  std::int64_t register_writes = 0;  ///< write requests that left for the device
};

/// Is told every request and what came of it, on the thread that asked: it may neither wait nor
/// allocate. The time of an exchange is left to it.
struct ExchangeListener {
  void (*tell)(void* owner, const BusExchange& exchange) = nullptr;
  void* owner = nullptr;
};

class ModbusLink {
 public:
  ModbusLink(const BatteryLinkSettings& settings, const LinkTiming& timing,
             const ScaledClock& clock);

  /// Connects if needed. `registers` holds at least `span.count` and is filled only on kOk.
  Status read(const RegisterSpan& span, std::uint16_t* registers);
  /// `function` 6 writes the first register alone, 16 writes `count` of them at once.
  /// Nothing leaves after `send_until_ns` (CLOCK_MONOTONIC), which connecting and the device's gap
  /// may take it past: kTooLate.
  Status write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
               const std::uint16_t* registers, int count, std::int64_t send_until_ns = INT64_MAX);
  void close();
  void tell_exchanges(const ExchangeListener& listener) { listener_ = listener; }

  /// The exception code of the last request, 0 when the device answered none: for register maps
  /// that give a vendor's code a meaning of their own.
  [[nodiscard]] int last_exception() const { return last_exception_; }
  /// The unit that answered the last request in place of the one that was asked; -1: none did.
  [[nodiscard]] int foreign_unit() const { return foreign_unit_; }
  [[nodiscard]] int asked_unit() const { return asked_unit_; }
  [[nodiscard]] const LinkCounters& counters() const { return counters_; }

 private:
  Status request(ModbusRequest request, std::uint16_t* registers, std::int64_t send_until_ns);
  Status make_ready(const ModbusRequest& request);
  Status connect();
  Status ask(const ModbusRequest& request, std::uint16_t* registers, std::int64_t send_until_ns);
  Status receive_reply(const ModbusRequest& request, std::int64_t deadline_ns, ModbusFrame& reply);
  void finish(const ModbusRequest& request, Status status);
  void tell(const ModbusRequest& request, const std::uint16_t* registers, Status status,
            std::int64_t asked_ns) const;
  void recover(Status status);
  [[nodiscard]] std::int64_t line_time_ns(int bytes) const;

  bool rtu_;
  Framing framing_;
  std::int32_t baud_;
  LinkTiming timing_;
  ModbusWire wire_;
  LinkStateMachine state_;
  UnansweredRequests unanswered_;
  LinkCounters counters_;
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
