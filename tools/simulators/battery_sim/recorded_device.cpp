#include "tools/simulators/battery_sim/recorded_device.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// Requests are within seconds of their ticks; ticks are two minutes apart.
constexpr std::int64_t kSlackNs = 20 * kNanosecondsPerSecond;
constexpr std::int32_t kIllegalDataAddress = 2;

std::string request_text(const BusExchange& request) {
  return fmt::format("{} of {} register{} at {}, unit {}, function {}",
                     request.is_write() ? "write" : "read", request.count,
                     request.count == 1 ? "" : "s", request.address, request.unit,
                     request.function);
}

/// The reaction of a device to other values than the recorded ones is unknown.
std::string difference(const BusExchange& recorded, const BusExchange& request) {
  if (!request.is_write() || std::ranges::equal(request.values(), recorded.values())) return "";
  return fmt::format("{}: [{}], at {} it was [{}]: the device continues as recorded",
                     request_text(request), fmt::join(request.values(), " "),
                     utc_text(recorded.utc_ns / kNanosecondsPerSecond).view(),
                     fmt::join(recorded.values(), " "));
}

}  // namespace

RecordingHead read_recording(const std::string& path, CutRecording cut,
                             const std::function<void(const BusExchange&)>& visit) {
  BusRecordingReader reader;
  std::string error;
  if (!reader.open(path, cut, error)) throw UserError(error);
  BusExchange exchange;
  auto next = reader.next(exchange, error);
  for (; next == BusRecordingReader::Next::kExchange; next = reader.next(exchange, error)) {
    visit(exchange);
  }
  if (next == BusRecordingReader::Next::kDamaged) throw UserError(error);
  return reader.head();
}

RecordedDevice::RecordedDevice(const std::string& path, CutRecording cut) {
  head_ = read_recording(path, cut, [this](const BusExchange& exchange) { add(exchange); });
  if (entries_.empty()) fail("{}: the recording has no exchanges", path);
}

void RecordedDevice::add(const BusExchange& exchange) {
  histories_[{exchange.unit, exchange.function, exchange.address, exchange.count}]
      .entries.push_back(entries_.size());
  entries_.push_back(exchange);
  if (exchange.is_write()) return;
  int address = exchange.address;
  for (const std::uint16_t value : exchange.values()) {
    readings_[{exchange.unit, exchange.function == 4, address++}].push_back(
        {exchange.utc_ns, value});
  }
}

bool RecordedDevice::has_unit(std::int32_t unit) const {
  return std::any_of(histories_.begin(), histories_.end(),
                     [unit](const auto& history) { return std::get<0>(history.first) == unit; });
}

std::string RecordedDevice::answer(BusExchange& request) {
  const auto history =
      histories_.find({request.unit, request.function, request.address, request.count});
  if (history != histories_.end()) {
    const BusExchange& recorded = now_in(history->second, request.utc_ns);
    std::string reported = difference(recorded, request);
    request.outcome = recorded.outcome;
    request.exception = recorded.exception;
    request.latency_us = recorded.latency_us;
    if (!request.is_write()) std::ranges::copy(recorded.values(), request.registers.begin());
    return reported;
  }
  if (!request.is_write() && assemble(request)) return "";
  request.outcome = BusOutcome::kException;
  request.exception = kIllegalDataAddress;
  return request_text(request) + ": was never recorded, answered with exception 2";
}

/// Next answer of this request, or the previous one until its time. The first one is valid at any
/// time.
const BusExchange& RecordedDevice::now_in(RequestHistory& history, std::int64_t utc_ns) const {
  const auto entry = [&](std::size_t i) -> const BusExchange& {
    return entries_[history.entries[i]];
  };
  const std::size_t count = history.entries.size();
  // Skip answers that a later one has replaced.
  while (history.next + 1 < count && entry(history.next + 1).utc_ns <= utc_ns - kSlackNs) {
    ++history.next;
  }
  const bool has_come = history.next < count && entry(history.next).utc_ns <= utc_ns + kSlackNs;
  if (has_come || history.next == 0) ++history.next;
  return entry(history.next - 1);
}

/// False if one of the registers was never read.
bool RecordedDevice::assemble(BusExchange& request) const {
  for (std::size_t i = 0; i < request.count; ++i) {
    const auto found = readings_.find(
        {request.unit, request.function == 4, request.address + static_cast<int>(i)});
    if (found == readings_.end()) return false;
    const std::vector<Reading>& readings = found->second;
    const auto after = std::upper_bound(
        readings.begin(), readings.end(), request.utc_ns,
        [](std::int64_t utc_ns, const Reading& reading) { return utc_ns < reading.utc_ns; });
    request.registers[i] = after == readings.begin() ? after->value : std::prev(after)->value;
  }
  request.outcome = BusOutcome::kAnswered;
  return true;
}

}  // namespace bess
