// What a start takes over from the runs before, from wherever it can still be read. That there was
// nothing before is not the same as that nothing can be read: the first is a new battery, the
// second may have been a trip.
#pragma once

#include <cstdint>
#include <string>

#include "edge/log/ring_log.h"
#include "edge/storage/trip_clearance.h"

namespace bess {

struct Recall {
  CycleRecord before{};  ///< the newest record of both logs; empty where there is none
  Trip trip{};           ///< in force: one of the logs says so, and no person has cleared it
  std::string unknown;   ///< not empty: what earlier runs left cannot be read, why
};

/// Of a start that cannot read what earlier runs left: the battery may have tripped, and nobody
/// knows. A trip that is known stays.
inline Trip trip_without_state(const Recall& recalled, std::int64_t now_utc_s) {
  if (recalled.unknown.empty() || recalled.trip.is_set()) return recalled.trip;
  return {.reason = Reason::kStateLost, .utc_s = now_utc_s};
}

/// The trip by the newest records, wherever they are, that nobody has cleared; not set where there
/// is none.
Trip standing_trip(const RingLog& ring, const RingLog& run_ring, const BothPlaces& cleared);

/// `published_number`: of the newest record that a status.json knows; 0 = none does.
Recall recall(const RingLog& ring, const RingLog& run_ring, std::uint64_t published_number,
              const BothPlaces& cleared);

}  // namespace bess
