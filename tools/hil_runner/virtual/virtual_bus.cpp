#include "tools/hil_runner/virtual/virtual_bus.h"

#include <algorithm>
#include <map>

#include "edge/core/base/check.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// All existing buses by their port.
std::map<std::int32_t, VirtualBus*>& buses() {
  static std::map<std::int32_t, VirtualBus*> all;
  return all;
}

/// Context for frames only; opens nothing.
modbus_t* make_context(bool rtu, int unit) {
  modbus_t* const context =
      rtu ? modbus_new_rtu("none", 9'600, 'N', 8, 1) : modbus_new_tcp("127.0.0.1", 1502);
  if (context == nullptr) fail("no memory for libmodbus");
  modbus_set_slave(context, unit);
  return context;
}

}  // namespace

VirtualBus::VirtualBus(const VirtualBusSettings& settings, const RegisterMap& map,
                       SimulatedBattery& battery, VirtualTime& time, MeteredHouse* house)
    : settings_(settings),
      time_(time),
      baud_(map.baud),
      context_(make_context(settings.rtu, map.unit)),
      device_(map, battery, context_.get(), settings.faults, settings.rtu, settings.start_utc_ns,
              house) {
  BESS_CHECK(buses().emplace(settings.port, this).second);
}

VirtualBus::~VirtualBus() { buses().erase(settings_.port); }

VirtualBus* VirtualBus::at(std::int32_t port) {
  const auto found = buses().find(port);
  return found == buses().end() ? nullptr : found->second;
}

Status VirtualBus::open() {
  ++connection_;
  input_.clear();
  is_half_open_ = false;
  is_cut_ = device_.on_connect(time_.utc_ns()) == BatteryFault::kRefuse;
  return Status::kOk;
}

/// A serial line has no connection: pending bytes still arrive.
void VirtualBus::close() {
  if (settings_.rtu) return;
  ++connection_;
  input_.clear();
}

bool VirtualBus::is_lost() {
  answer_due();
  if (settings_.rtu) return false;
  discard_input();
  return is_cut_;
}

void VirtualBus::discard_input() {
  answer_due();
  std::erase_if(input_, [this](const auto& b) { return b.arrives_ns <= time_.monotonic_ns(); });
}

Status VirtualBus::send(const ModbusFrame& frame) {
  sent_.add(time_.monotonic_ns());
  for (int i = 0; i < frame.size; ++i) sent_.add(frame.bytes[i]);
  if (is_cut_) return Status::kNotConnected;
  answer_due();
  Pending pending{.connection = connection_};
  BusRequest& request = pending.request;
  std::copy_n(frame.bytes, frame.size, request.bytes);
  request.size = frame.size;
  request.header = settings_.rtu ? 0 : kTcpHeaderBytes;
  const bool is_heard =
      device_.serves_unit(request.unit()) && !is_half_open_ && !time_.battery_is_paused();
  if (!is_heard) return Status::kOk;
  // Sequential, like a single-threaded device.
  const std::int64_t heard_ns = time_.monotonic_ns() + line_ns(frame.size);
  const std::int64_t begun_ns =
      pending_.empty() ? heard_ns : std::max(heard_ns, pending_.back().due_ns);
  pending.fault = device_.on_request(request, time_.utc_ns());
  pending.window = device_.struck();
  pending.due_ns = begun_ns + settings_.response_delay_ms * kMillisecondNs;
  if (pending.fault == BatteryFault::kLate) {
    pending.due_ns += window_of(pending).late_ms * kMillisecondNs;
  }
  pending_.push_back(pending);
  return Status::kOk;
}

Status VirtualBus::receive(int count, std::int64_t deadline_ns, ModbusFrame& frame) {
  while (true) {
    answer_due();
    const std::int64_t now_ns = time_.monotonic_ns();
    const int before = frame.size;
    while (!input_.empty() && input_.front().arrives_ns <= now_ns && frame.size < before + count) {
      frame.bytes[frame.size++] = input_.front().byte;
      input_.pop_front();
    }
    if (frame.size > before) return Status::kOk;
    if (is_cut_) return Status::kNotConnected;
    std::int64_t next_ns = INT64_MAX;
    if (!input_.empty()) next_ns = input_.front().arrives_ns;
    for (const Pending& pending : pending_) next_ns = std::min(next_ns, pending.due_ns);
    if (now_ns >= deadline_ns) return Status::kTimeout;
    time_.advance_to(std::min(next_ns, deadline_ns));
  }
}

void VirtualBus::answer_due() {
  while (!pending_.empty() && pending_.front().due_ns <= time_.monotonic_ns()) {
    const Pending pending = pending_.front();
    pending_.pop_front();
    answer(pending);
  }
}

const FaultSchedule& VirtualBus::window_of(const Pending& pending) const {
  return settings_.faults.at(pending.window);  // the fault belongs to one of them
}

void VirtualBus::answer(const Pending& pending) {
  const bool is_heard = settings_.rtu || pending.connection == connection_;
  const std::int64_t due_utc_ns = time_.utc_ns() - time_.monotonic_ns() + pending.due_ns;
  switch (pending.fault) {
    case BatteryFault::kSilence:
      return;
    case BatteryFault::kHalfOpen:
      if (is_heard) is_half_open_ = true;
      return;
    case BatteryFault::kDrop:
    case BatteryFault::kReset:
      if (is_heard) is_cut_ = true;
      return;
    case BatteryFault::kException:
      if (!is_heard) return;
      return put(device_.exception(pending.request, window_of(pending).exception_code),
                 pending.due_ns);
    default:
      break;
  }
  const Bytes bytes = device_.answer(pending.request, pending.fault, due_utc_ns);
  if (!is_heard) return;
  if (listener_ && pending.fault == BatteryFault::kNone) {
    const auto header = static_cast<std::size_t>(pending.request.header);
    const auto size = static_cast<std::size_t>(pending.request.size);
    listener_({pending.request.bytes + header, size - header}, std::span(bytes).subspan(header),
              due_utc_ns);
  }
  if (pending.fault == BatteryFault::kDrip) {
    return put(bytes, pending.due_ns, window_of(pending).drip_ms * kMillisecondNs);
  }
  if (pending.fault != BatteryFault::kByteGap) return put(bytes, pending.due_ns);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
  put({bytes.begin(), middle}, pending.due_ns);
  put({middle, bytes.end()}, pending.due_ns + window_of(pending).late_ms * kMillisecondNs);
}

void VirtualBus::put(const Bytes& bytes, std::int64_t first_ns, std::int64_t gap_ns) {
  const std::int64_t last_ns = input_.empty() ? first_ns : input_.back().arrives_ns;
  std::int64_t arrives_ns = first_ns;
  for (const std::uint8_t byte : bytes) {
    arrives_ns += line_ns(1);
    input_.push_back({.arrives_ns = arrives_ns, .byte = byte});
    arrives_ns += gap_ns;
  }
  // A later answer may overtake dripping bytes.
  if (last_ns > first_ns) std::ranges::stable_sort(input_, {}, &ByteInTransit::arrives_ns);
}

/// Transmission time on a serial line, 10 bits per byte.
std::int64_t VirtualBus::line_ns(int bytes) const {
  return settings_.rtu ? bytes * 10 * kNanosecondsPerSecond / baud_ : 0;
}

}  // namespace bess
