#include "edge/records/log/log_reader.h"

#include <algorithm>

namespace bess {

bool LogReader::open(const EventLogSettings& settings, FileMessage& error) {
  FileMessage ignored;
  const bool has_run_ring =
      !settings.run_ring.empty() && run_ring_.open_to_read(settings.run_ring.c_str(), ignored);
  return ring_.open_to_read(settings.ring.c_str(), error) || has_run_ring;
}

std::uint64_t LogReader::newest_number() const {
  return std::max(ring_.newest_number(), run_ring_.newest_number());
}

std::uint64_t LogReader::oldest_number() const {
  if (ring_.newest_number() == 0) return run_ring_.oldest_number();
  if (run_ring_.newest_number() == 0) return ring_.oldest_number();
  return std::min(ring_.oldest_number(), run_ring_.oldest_number());
}

bool LogReader::read(std::uint64_t number, CycleRecord& record) const {
  return (ring_.is_open() && ring_.read(number, record)) ||
         (run_ring_.is_open() && run_ring_.read(number, record));
}

}  // namespace bess
