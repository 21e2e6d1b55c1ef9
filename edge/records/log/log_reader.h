// Reader of the decision log: the ring of the state folder and the short ring of the run folder, if
// any, which continues after a disk failure.
#pragma once

#include <cstdint>

#include "edge/records/log/event_log.h"
#include "edge/records/log/ring_log.h"

namespace bess {

class LogReader {
 public:
  /// False with one line, of the state folder's ring, when neither can be read.
  bool open(const EventLogSettings& settings, FileMessage& error);

  /// As in RingLog. Numbers between may be missing.
  [[nodiscard]] std::uint64_t newest_number() const;
  [[nodiscard]] std::uint64_t oldest_number() const;
  bool newest(CycleRecord& record) const { return read(newest_number(), record); }
  bool read(std::uint64_t number, CycleRecord& record) const;

  [[nodiscard]] const RingLog& ring() const { return ring_; }
  [[nodiscard]] const RingLog& run_ring() const { return run_ring_; }

 private:
  RingLog ring_;
  RingLog run_ring_;
};

}  // namespace bess
