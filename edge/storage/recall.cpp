#include "edge/storage/recall.h"

#include <algorithm>

namespace bess {
namespace {

std::string why_nothing_is_known(const RingLog& ring, std::uint64_t published_number) {
  if (!ring.is_open()) return "the decision log can be neither read nor made";
  if (ring.damage().is_any()) return "nothing in the decision log can be understood";
  if (published_number == 0) return "";  // a new battery
  return "the decision log is gone, although a controller has run here";
}

std::string why_unknown(const RingLog& ring, const RingLog& run_ring,
                        std::uint64_t published_number) {
  const std::uint64_t newest = std::max(ring.newest_number(), run_ring.newest_number());
  if (newest == 0) return why_nothing_is_known(ring, published_number);
  // One record less is one cycle less; several may hide a trip.
  const bool knows_more = run_ring.newest_number() > ring.newest_number();
  if (!knows_more && ring.damage().newest_lost > 1) {
    return "the newest records of the decision log are lost, perhaps " +
           std::to_string(ring.damage().newest_lost);
  }
  if (published_number > newest + 1) {
    return "the decision log ends with record " + std::to_string(newest) +
           ", although there was a record " + std::to_string(published_number);
  }
  return "";
}

}  // namespace

Trip standing_trip(const RingLog& ring, const RingLog& run_ring, const BothPlaces& cleared) {
  const bool run_is_newer = run_ring.newest_number() > ring.newest_number();
  const RingLog& newer = run_is_newer ? run_ring : ring;
  const RingLog& other = run_is_newer ? ring : run_ring;
  CycleRecord record;
  for (const RingLog* log : {&newer, &other}) {
    const bool is_tripped =
        log->newest(record) && record.is_tripped && !is_trip_cleared(cleared, record.trip.utc_s);
    if (is_tripped) return record.trip;
  }
  return {};
}

Recall recall(const RingLog& ring, const RingLog& run_ring, std::uint64_t published_number,
              const BothPlaces& cleared) {
  Recall recalled;
  const bool run_is_newer = run_ring.newest_number() > ring.newest_number();
  static_cast<void>((run_is_newer ? run_ring : ring).newest(recalled.before));
  recalled.trip = standing_trip(ring, run_ring, cleared);
  recalled.unknown = why_unknown(ring, run_ring, published_number);
  return recalled;
}

}  // namespace bess
