// Reader of the decision log: the ring of the state folder and the short ring of the run folder, if
// any, which continues after a disk failure.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/records/log/event_log.h"
#include "edge/records/log/ring_log.h"

namespace bess {

class LogReader {
 public:
  /// False with one line, of the state folder's ring, when neither can be read.
  bool open(const EventLogSettings& settings, FileMessage& error) {
    FileMessage ignored;
    const bool has_run_ring =
        !settings.run_ring.empty() && run_ring_.open_to_read(settings.run_ring.c_str(), ignored);
    return ring_.open_to_read(settings.ring.c_str(), error) || has_run_ring;
  }

  /// As in RingLog. Numbers between may be missing.
  [[nodiscard]] std::uint64_t newest_number() const {
    return std::max(ring_.newest_number(), run_ring_.newest_number());
  }
  [[nodiscard]] std::uint64_t oldest_number() const {
    if (ring_.newest_number() == 0) return run_ring_.oldest_number();
    if (run_ring_.newest_number() == 0) return ring_.oldest_number();
    return std::min(ring_.oldest_number(), run_ring_.oldest_number());
  }
  bool newest(CycleRecord& record) const { return read(newest_number(), record); }
  bool read(std::uint64_t number, CycleRecord& record) const {
    return (ring_.is_open() && ring_.read(number, record)) ||
           (run_ring_.is_open() && run_ring_.read(number, record));
  }

  [[nodiscard]] const RingLog& ring() const { return ring_; }
  [[nodiscard]] const RingLog& run_ring() const { return run_ring_; }

 private:
  RingLog ring_;
  RingLog run_ring_;
};

}  // namespace bess
