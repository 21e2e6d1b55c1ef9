// Recorded device (shared/host/bus_recording.h): answers a request as at that time of the
// recording. Two rules make a replay insensitive to milliseconds:
//   recorded request    its answers in order, each at its time within `kSlackNs`; answers that were
//                       not requested in time are skipped
//   other read          each register as last read before this time
// A request without any recorded value gets exception 2, with a message.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "shared/bus_exchange.h"
#include "shared/host/bus_recording.h"

namespace bess {

class RecordedDevice {
 public:
  /// Reads the whole recording. Throws UserError naming file and line.
  RecordedDevice(const std::string& path, CutRecording cut);

  [[nodiscard]] const RecordingHead& head() const { return head_; }
  [[nodiscard]] std::int64_t exchanges() const { return std::ssize(entries_); }
  [[nodiscard]] std::int64_t first_utc_ns() const { return first_utc_ns_; }
  [[nodiscard]] std::int64_t last_utc_ns() const { return last_utc_ns_; }
  [[nodiscard]] bool has_unit(std::int32_t unit) const;

  /// Fills outcome, exception, latency and the read registers of `request`, for its `utc_ns`.
  /// Returns a message, or "".
  std::string answer(BusExchange& request);

 private:
  using Key = std::tuple<std::int32_t, int, int, int>;  ///< unit, function, address, count
  struct Entry {
    std::int64_t utc_ns = 0;
    std::int64_t latency_us = 0;
    BusOutcome outcome = BusOutcome::kAnswered;
    std::int32_t exception = 0;
    std::vector<std::uint16_t> values;  ///< read or written
  };
  struct RequestHistory {
    std::vector<std::size_t> entries;  ///< in the order of time
    std::size_t next = 0;
  };
  struct Reading {
    std::int64_t utc_ns;
    std::uint16_t value;
  };
  using Place = std::tuple<std::int32_t, bool, int>;  ///< unit, input register, address

  void add(const BusExchange& exchange);
  [[nodiscard]] const Entry& now_in(RequestHistory& history, std::int64_t utc_ns) const;
  static void give(const Entry& entry, BusExchange& request);
  static std::string difference(const Entry& entry, const BusExchange& request);
  [[nodiscard]] bool assemble(BusExchange& request) const;

  RecordingHead head_;
  std::int64_t first_utc_ns_ = 0, last_utc_ns_ = 0;
  std::vector<Entry> entries_;
  std::map<Key, RequestHistory> histories_;
  std::map<Place, std::vector<Reading>> readings_;
};

}  // namespace bess
