// How a person's word that the battery may be driven again reaches the controller: a small file in the
// [state] folder names the trip that was cleared, by the instant it was found at. The controller
// looks at it once a cycle while it is tripped, and at its start.
#pragma once

#include <cstdint>

#include "edge/log/ring_log.h"
#include "edge/program/edge_config.h"

namespace bess {

FixedText<639> trip_clearance_path(const EdgeConfig& config);

/// False with errno set. On the disk before it returns.
bool clear_trip_of(const char* path, std::int64_t trip_utc_s);

/// The trip that stands by the newest record, and that nobody has cleared; not set where there is none.
Trip standing_trip(const RingLog& ring, const EdgeConfig& config);

/// Whether the trip found at this instant was cleared. Allocates nothing.
bool is_trip_cleared(const char* path, std::int64_t trip_utc_s);

}  // namespace bess
