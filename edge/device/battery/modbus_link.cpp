#include "edge/device/battery/modbus_link.h"

#include <algorithm>

namespace bess {
namespace {

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;

std::int64_t milliseconds(std::int32_t ms) { return ms * kNanosecondsPerMillisecond; }

std::int64_t now() { return clock_ns(CLOCK_MONOTONIC); }

void sleep_until(std::int64_t monotonic_ns) {
  while (now() < monotonic_ns) sleep_until_monotonic(monotonic_ns);
}

LinkTiming with_timeout(LinkTiming timing, const BatteryLinkSettings& settings) {
  if (settings.response_timeout_ms > 0) timing.response_timeout_ms = settings.response_timeout_ms;
  return timing;
}

/// Device and network delays run in simulated time, the bus itself in wall time.
LinkPauses pauses_of(const LinkTiming& timing, const ScaledClock& clock) {
  return {.back_off_first_ns = clock.wall_ns(kBackOffFirstS * kNanosecondsPerSecond),
          .back_off_max_ns = clock.wall_ns(kBackOffMaxS * kNanosecondsPerSecond),
          .connect_delay_ns = clock.wall_ns(milliseconds(timing.connect_delay_ms)),
          .gap_ns = clock.wall_ns(milliseconds(timing.minimum_gap_ms)),
          .quiet_ns = std::max(milliseconds(timing.response_timeout_ms),
                               clock.wall_ns(milliseconds(timing.quiet_ms)))};
}

BusOutcome outcome_of(Status status, int exception) {
  if (exception != 0) return BusOutcome::kException;
  if (status == Status::kOk) return BusOutcome::kAnswered;
  if (status == Status::kTimeout) return BusOutcome::kTimeout;
  return status == Status::kBadReply ? BusOutcome::kBadReply : BusOutcome::kNotConnected;
}

std::int64_t late_reply_ns_max(const LinkTiming& timing, const ScaledClock& clock) {
  return std::max(5 * milliseconds(timing.response_timeout_ms),
                  clock.wall_ns(milliseconds(timing.late_reply_ms_max)));
}

}  // namespace

ModbusLink::ModbusLink(const BatteryLinkSettings& settings, const LinkTiming& timing,
                       const ScaledClock& clock)
    : rtu_(settings.rtu),
      framing_(settings.rtu ? Framing::kRtu : Framing::kTcp),
      baud_(settings.baud),
      timing_(with_timeout(timing, settings)),
      wire_(settings, timing_.response_timeout_ms),
      state_(pauses_of(timing_, clock)),
      unanswered_(late_reply_ns_max(timing_, clock)) {}

Status ModbusLink::read(const RegisterSpan& span, std::uint16_t* registers) {
  return request(
      {.unit = span.unit, .function = span.function, .address = span.address, .count = span.count},
      registers, INT64_MAX);
}

Status ModbusLink::write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
                         const std::uint16_t* registers, int count, std::int64_t send_until_ns) {
  return request({.unit = unit,
                  .function = function,
                  .address = address,
                  .count = function == 6 ? 1 : count,
                  .values = registers},
                 nullptr, send_until_ns);
}

void ModbusLink::close() {
  wire_.close();
  state_.on_lost(now());
}

Status ModbusLink::request(ModbusRequest request, std::uint16_t* registers,
                           std::int64_t send_until_ns) {
  last_exception_ = 0;
  foreign_unit_ = -1;
  asked_unit_ = request.unit;
  if (!request.is_valid()) return Status::kNotExpressible;
  ++counters_.requests;
  const std::int64_t asked_ns = now();
  Status status = make_ready(request);
  if (status == Status::kOk) {
    request.transaction = ++transaction_;
    status = ask(request, registers, send_until_ns);
    if (status != Status::kTooLate) finish(request, status);
  }
  if (status != Status::kOk) ++counters_.failed_requests;
  if (listener_.on_exchange != nullptr && status != Status::kTooLate) {
    report_exchange(request, registers, status, asked_ns);
  }
  return status;
}

/// Connects, waits for the gap, and excludes replies that could be mistaken for this request's.
Status ModbusLink::make_ready(const ModbusRequest& request) {
  if (state_.state(now()) == LinkState::kConnected && wire_.is_lost()) close();
  const LinkState state = state_.state(now());
  if (state == LinkState::kBackingOff) return connect_status_;
  if (state == LinkState::kDisconnected && connect() != Status::kOk) return connect_status_;
  if (state == LinkState::kDraining) {
    sleep_until(state_.ready_ns());
    state_.on_drained();
  }
  sleep_until(state_.ready_ns());
  if (!rtu_) return Status::kOk;
  if (!request.is_write()) sleep_until(unanswered_.earliest_ns(request));
  unanswered_.forget_old(now());
  wire_.discard_input();
  return Status::kOk;
}

Status ModbusLink::connect() {
  connect_status_ = wire_.open();
  if (connect_status_ != Status::kOk) {
    state_.on_connect_failed(now());
    return connect_status_;
  }
  if (was_connected_) ++counters_.reconnects;
  was_connected_ = true;
  state_.on_connected(now());
  return Status::kOk;
}

Status ModbusLink::ask(const ModbusRequest& request, std::uint16_t* registers,
                       std::int64_t send_until_ns) {
  ModbusFrame frame;
  build_request(framing_, request, frame);
  sent_ns_ = now();
  if (sent_ns_ > send_until_ns) return Status::kTooLate;
  if (const Status status = wire_.send(frame); status != Status::kOk) return status;
  if (request.is_write()) ++counters_.register_writes;
  const std::int64_t deadline_ns = sent_ns_ + milliseconds(timing_.response_timeout_ms) +
                                   line_time_ns(frame.size + reply_bytes_max(framing_, request));
  ModbusFrame reply;
  do {  // a late reply belongs to an earlier request
    reply.size = 0;
    const Status status = receive_reply(request, deadline_ns, reply);
    if (status != Status::kOk) return status;
  } while (!rtu_ && is_stale(request, reply));
  const ReplyCheck check = check_reply(framing_, request, reply, registers);
  last_exception_ = check.exception;
  foreign_unit_ = check.foreign_unit;
  return check.status;
}

Status ModbusLink::receive_reply(const ModbusRequest& request, std::int64_t deadline_ns,
                                 ModbusFrame& reply) {
  int missing = missing_bytes(framing_, request, reply);
  while (missing > 0) {
    const Status status = wire_.receive(missing, deadline_ns, reply);
    if (status != Status::kOk) return status;
    missing = missing_bytes(framing_, request, reply);
  }
  return missing == 0 ? Status::kOk : Status::kBadReply;
}

void ModbusLink::finish(const ModbusRequest& request, Status status) {
  const bool answered = status == Status::kOk || last_exception_ != 0;
  if (rtu_) {
    // An exception looks the same for every count: while old replies may come, it is no evidence.
    if (status == Status::kOk) unanswered_.on_answered(request, sent_ns_);
    if (!answered || (last_exception_ != 0 && !unanswered_.empty())) {
      unanswered_.add(request, sent_ns_);
    }
  }
  if (answered) return state_.on_answered(now());
  if (rtu_ && status != Status::kNotConnected) return state_.on_no_answer(now());
  close();
}

void ModbusLink::report_exchange(const ModbusRequest& request, const std::uint16_t* registers,
                                 Status status, std::int64_t asked_ns) const {
  const std::int64_t begin_ns = std::max(asked_ns, sent_ns_);  // gap and connecting are not latency
  BusExchange exchange{.latency_us = (now() - begin_ns) / 1'000,
                       .unit = request.unit,
                       .function = request.function,
                       .outcome = outcome_of(status, last_exception_),
                       .exception = last_exception_,
                       .address = request.address,
                       .count = static_cast<std::uint16_t>(request.count)};
  const std::uint16_t* const values = request.is_write() ? request.values : registers;
  std::copy_n(values, exchange.values().size(), exchange.registers.begin());
  listener_.on_exchange(listener_.owner, exchange);
}

/// Time of `bytes` on a serial line: 11 bits each with parity or a second stop bit.
std::int64_t ModbusLink::line_time_ns(int bytes) const {
  return rtu_ ? bytes * 11 * kNanosecondsPerSecond / baud_ : 0;
}

}  // namespace bess
