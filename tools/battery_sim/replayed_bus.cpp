#include "tools/battery_sim/replayed_bus.h"

#include <algorithm>
#include <cstdio>

#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int32_t kIllegalFunction = 1;

std::uint16_t word_at(const BusRequest& request, int offset) {
  const int at = request.header + offset;
  return static_cast<std::uint16_t>(request.bytes[at] << 8 | request.bytes[at + 1]);
}

/// False for a function that no recording holds.
bool read_request(const BusRequest& request, BusExchange& exchange) {
  exchange.unit = request.unit();
  exchange.function = static_cast<std::uint8_t>(request.function());
  exchange.address = static_cast<std::uint16_t>(request.address());
  const bool is_read = exchange.function == 3 || exchange.function == 4;
  if (!is_read && !exchange.is_write()) return false;
  const int count = is_read ? word_at(request, 4) : request.write_count();
  if (count < 1 || count > BusExchange::kRegistersMax) return false;
  exchange.count = static_cast<std::uint16_t>(count);
  if (is_read) return true;
  const int first = exchange.function == 6 ? 4 : 7;  // behind address, or count and bytes
  for (int i = 0; i < count; ++i) {
    exchange.registers[static_cast<std::size_t>(i)] = word_at(request, first + 2 * i);
  }
  return true;
}

void add_word(Bytes& bytes, int word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word));
}

}  // namespace

BusExchange ReplayedBus::answer(const BusRequest& request) {
  BusExchange exchange;
  const std::int64_t now_ns = clock_.now_utc_ns();
  if (!has_begun_ && clock_.is_real_time()) shift_ns_ = device_.first_utc_ns() - now_ns;
  has_begun_ = true;
  exchange.utc_ns = now_ns + shift_ns_;
  if (!read_request(request, exchange)) {
    exchange.outcome = BusOutcome::kException;
    exchange.exception = kIllegalFunction;
    return exchange;
  }
  const std::string told = device_.answer(exchange);
  if (!told.empty()) {
    std::printf("%s %s\n", utc_text(exchange.utc_ns / kNanosecondsPerSecond).c_str(), told.c_str());
    std::fflush(stdout);
  }
  return exchange;
}

std::int32_t ReplayedBus::latency_ms(const BusExchange& answer) const {
  constexpr std::int64_t kLatencyMsMax = 60'000;
  const std::int64_t simulated_us = answer.latency_us * device_.head().time_scale;
  return static_cast<std::int32_t>(std::min(simulated_us / clock_.scale / 1'000, kLatencyMsMax));
}

Bytes ReplayedBus::content(const BusExchange& answer) {
  Bytes bytes = {static_cast<std::uint8_t>(answer.unit), answer.function};
  if (answer.is_write()) {
    add_word(bytes, answer.address);
    add_word(bytes, answer.function == 6 ? answer.registers[0] : answer.count);
    return bytes;
  }
  bytes.push_back(static_cast<std::uint8_t>(2 * answer.count));
  for (int i = 0; i < answer.count; ++i) {
    add_word(bytes, answer.registers[static_cast<std::size_t>(i)]);
  }
  return bytes;
}

}  // namespace bess
