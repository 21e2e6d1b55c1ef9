// Modbus request and its result, in fixed size: for listeners of the edge's link, lines of a
// recording (host/bus_recording.h), and replay in the simulator.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace bess {

enum class BusOutcome : std::uint8_t {
  kAnswered,
  kException,     ///< refused by the device with a code
  kTimeout,       ///< no complete reply in time
  kNotConnected,  ///< connection refused or lost
  kBadReply,      ///< not a reply to the request
};

inline constexpr std::array<std::string_view, 5> kBusOutcomeNames = {
    "answered", "exception", "timeout", "not_connected", "bad_reply"};

struct BusExchange {
  static constexpr int kRegistersMax = 125;  ///< limit of the protocol

  std::int64_t utc_ns = 0;      ///< time of the request by the edge's clock
  std::int64_t latency_us = 0;  ///< wall time from request to outcome
  std::int32_t unit = 0;
  std::uint8_t function = 3;  ///< 3 and 4 read, 6 and 16 write
  BusOutcome outcome = BusOutcome::kAnswered;
  std::int32_t exception = 0;  ///< 0 = none
  std::uint16_t address = 0;   ///< PDU address, 0-based
  std::uint16_t count = 0;
  std::array<std::uint16_t, kRegistersMax> registers{};  ///< read, or written; see `values`

  [[nodiscard]] bool is_write() const { return function == 6 || function == 16; }
  /// Written values, whatever the outcome, or read values; may be empty.
  [[nodiscard]] std::span<const std::uint16_t> values() const {
    const bool has_values = is_write() || outcome == BusOutcome::kAnswered;
    return {registers.data(), has_values ? count : std::size_t{0}};
  }
};

}  // namespace bess
