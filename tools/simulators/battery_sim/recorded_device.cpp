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

std::string instant_text(std::int64_t utc_ns) {
  return std::string(utc_text(utc_ns / kNanosecondsPerSecond).view());
}

}  // namespace

RecordedDevice::RecordedDevice(const std::string& path, CutRecording cut) {
  BusRecordingReader reader;
  std::string error;
  if (!reader.open(path, cut, error)) throw UserError(error);
  head_ = reader.head();
  BusExchange exchange;
  auto next = reader.next(exchange, error);
  for (; next == BusRecordingReader::Next::kExchange; next = reader.next(exchange, error)) {
    add(exchange);
  }
  if (next == BusRecordingReader::Next::kDamaged) throw UserError(error);
  if (entries_.empty()) fail("{}: the recording has no exchanges", path);
}

void RecordedDevice::add(const BusExchange& exchange) {
  const std::span<const std::uint16_t> values = exchange.values();
  if (entries_.empty()) first_utc_ns_ = exchange.utc_ns;
  last_utc_ns_ = exchange.utc_ns;
  histories_[{exchange.unit, exchange.function, exchange.address, exchange.count}]
      .entries.push_back(entries_.size());
  entries_.push_back({.utc_ns = exchange.utc_ns,
                      .latency_us = exchange.latency_us,
                      .outcome = exchange.outcome,
                      .exception = exchange.exception,
                      .values = {values.begin(), values.end()}});
  if (exchange.outcome != BusOutcome::kAnswered || exchange.is_write()) return;
  int address = exchange.address;
  for (const std::uint16_t value : values) {
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
    const Entry& entry = now_in(history->second, request.utc_ns);
    std::string reported = difference(entry, request);
    give(entry, request);
    return reported;
  }
  if (!request.is_write() && assemble(request)) return "";
  request.outcome = BusOutcome::kException;
  request.exception = kIllegalDataAddress;
  return request_text(request) + ": was never recorded, answered with exception 2";
}

/// Next answer of this request, or the previous one until its time. The first one is valid at any
/// time.
const RecordedDevice::Entry& RecordedDevice::now_in(RequestHistory& history,
                                                    std::int64_t utc_ns) const {
  const auto entry = [&](std::size_t i) -> const Entry& { return entries_[history.entries[i]]; };
  const std::size_t count = history.entries.size();
  // Skip answers that a later one has replaced.
  while (history.next + 1 < count && entry(history.next + 1).utc_ns <= utc_ns - kSlackNs) {
    ++history.next;
  }
  const bool has_come = history.next < count && entry(history.next).utc_ns <= utc_ns + kSlackNs;
  if (has_come || history.next == 0) ++history.next;
  return entry(history.next - 1);
}

void RecordedDevice::give(const Entry& entry, BusExchange& request) {
  request.outcome = entry.outcome;
  request.exception = entry.exception;
  request.latency_us = entry.latency_us;
  if (request.is_write()) return;
  std::ranges::copy(entry.values, request.registers.begin());
}

/// The reaction of a device to other values than the recorded ones is unknown.
std::string RecordedDevice::difference(const Entry& entry, const BusExchange& request) {
  if (!request.is_write()) return "";
  const std::span<const std::uint16_t> written = request.values();
  if (std::ranges::equal(written, entry.values)) return "";
  return fmt::format("{}: [{}], at {} it was [{}]: the device continues as recorded",
                     request_text(request), fmt::join(written, " "), instant_text(entry.utc_ns),
                     fmt::join(entry.values, " "));
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
