// What a start takes over from the runs before, from wherever it can still be read. That there was
// nothing before is not the same as that nothing can be read: the first is a new battery, the
// second may have been a trip.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/ring_log.h"

namespace bess {

// How a person's word that the battery may be driven again reaches the controller: a small file
// names the trips that were cleared, by the instant each was found at, newest first. It lies in the
// [state] folder and in its run_folder, because a trip that was cleared stays cleared if either
// says so: a disk that dies may have kept the trip and not the word.
//   bess-cleared 1 1679788800 1679702400 crc32=0123abcd

struct ClearedTrips {
  std::array<std::int64_t, 8> utc_s{};  ///< 0 = none
  bool unreadable = false;              ///< there is a file, and not one that was written here

  [[nodiscard]] bool has(std::int64_t trip_utc_s) const;
  void add(std::int64_t trip_utc_s);
};

using ClearanceText = FixedText<255>;
ClearanceText format_cleared(const ClearedTrips& cleared);
/// Anything but exactly what `format_cleared` writes is unreadable.
ClearedTrips parse_cleared(std::string_view text);
/// What lies at `path`; no file, and no path, is nothing cleared. Allocates nothing.
ClearedTrips read_cleared(const char* path);

inline constexpr std::string_view kClearedFileName = "cleared";

/// Whether the trip found at this instant was cleared. Allocates nothing.
bool is_trip_cleared(const BothPlaces& paths, std::int64_t trip_utc_s);

/// Adds the trip to what was cleared in this file, on the disk before it returns. False with errno
/// set.
bool clear_trip_of(const char* path, std::int64_t trip_utc_s);

struct Recall {
  CycleRecord before{};        ///< the newest record of both logs; empty where there is none
  std::optional<Trip> trip{};  ///< one of the logs says so, and no person has cleared it
  std::string unknown;         ///< not empty: what earlier runs left cannot be read, why
};

/// Of a start that cannot read what earlier runs left: the battery may have tripped, and nobody
/// knows. A trip that is known stays.
inline std::optional<Trip> trip_without_state(const Recall& recalled, std::int64_t now_utc_s) {
  if (recalled.unknown.empty() || recalled.trip) return recalled.trip;
  return Trip{.reason = Reason::kStateLost, .utc_s = now_utc_s};
}

/// The trip by the newest records, wherever they are, that no person has cleared.
std::optional<Trip> standing_trip(const RingLog& ring, const RingLog& run_ring,
                                  const BothPlaces& cleared);

/// `published_number`: of the newest record that a status.json knows; 0 = none does.
Recall recall(const RingLog& ring, const RingLog& run_ring, std::uint64_t published_number,
              const BothPlaces& cleared);

}  // namespace bess
