// One request to a Modbus device and what came of it, in fixed size: what the edge's link tells a
// listener, what a line of a recording holds (host/bus_recording.h), and what the simulator
// replays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace bess {

enum class BusOutcome : std::uint8_t {
  kAnswered,
  kException,     ///< the device refused, with a code
  kTimeout,       ///< no complete reply in time
  kNotConnected,  ///< nobody listened, or the connection was lost
  kBadReply,      ///< something that is no reply to the request
};

inline constexpr std::array<std::string_view, 5> kBusOutcomeNames = {
    "answered", "exception", "timeout", "not_connected", "bad_reply"};

struct BusExchange {
  static constexpr int kRegistersMax = 125;  ///< by the protocol

  std::int64_t utc_ns = 0;      ///< when it was asked, in the time of the edge's clock
  std::int64_t latency_us = 0;  ///< wall time from asking to the outcome
  std::int32_t unit = 0;
  std::uint8_t function = 3;  ///< 3 and 4 read, 6 and 16 write
  BusOutcome outcome = BusOutcome::kAnswered;
  std::int32_t exception = 0;  ///< 0 = none
  std::uint16_t address = 0;   ///< PDU address, 0-based
  std::uint16_t count = 0;
  std::array<std::uint16_t, kRegistersMax> registers{};  ///< read, or written; see `values`

  [[nodiscard]] bool is_write() const { return function == 6 || function == 16; }
  /// What was written, whatever came of it, or what was read; empty when nothing was.
  [[nodiscard]] std::span<const std::uint16_t> values() const {
    const bool has_values = is_write() || outcome == BusOutcome::kAnswered;
    return {registers.data(), has_values ? count : std::size_t{0}};
  }
};

}  // namespace bess
