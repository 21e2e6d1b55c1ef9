// Recorded device (shared/host/bus_recording.h): answers a request as at that time of the
// recording. Two rules make a replay insensitive to milliseconds:
//   recorded request    its answers in order, each at its time within `kSlackNs`; answers that were
//                       not requested in time are skipped
//   other read          each register as last read before this time
// A request without any recorded value gets exception 2, with a message.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "shared/bus_exchange.h"
#include "shared/host/bus_recording.h"

namespace bess {

/// Visits all exchanges of a recording; returns its head. Throws UserError naming file and line.
RecordingHead read_recording(const std::string& path, CutRecording cut,
                             const std::function<void(const BusExchange&)>& visit);

class RecordedDevice {
 public:
  /// Reads the whole recording. Throws UserError naming file and line.
  RecordedDevice(const std::string& path, CutRecording cut);

  [[nodiscard]] const RecordingHead& head() const { return head_; }
  [[nodiscard]] std::int64_t exchanges() const { return std::ssize(entries_); }
  [[nodiscard]] std::int64_t first_utc_ns() const { return entries_.front().utc_ns; }
  [[nodiscard]] std::int64_t last_utc_ns() const { return entries_.back().utc_ns; }
  [[nodiscard]] bool has_unit(std::int32_t unit) const;

  /// Fills outcome, exception, latency and the read registers of `request`, for its `utc_ns`.
  /// Returns a message, or "".
  std::string answer(BusExchange& request);

 private:
  using Key = std::tuple<std::int32_t, int, int, int>;  ///< unit, function, address, count
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
  [[nodiscard]] const BusExchange& now_in(RequestHistory& history, std::int64_t utc_ns) const;
  [[nodiscard]] bool assemble(BusExchange& request) const;

  RecordingHead head_;
  std::vector<BusExchange> entries_;  ///< never empty
  std::map<Key, RequestHistory> histories_;
  std::map<Place, std::vector<Reading>> readings_;
};

}  // namespace bess
