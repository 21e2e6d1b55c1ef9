// Restored state: reads what earlier runs left, from any readable copy. No earlier state means a
// new battery; unreadable state may hide a trip.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/ring_log.h"

namespace bess {

// Cleared trips: a small file in the [state] folder and in run_folder with the times of cleared
// trips, newest first. A trip is cleared if either file has it, because a failed disk may have the
// trip without its clearance.
//   bess-cleared 1 1679788800 1679702400 crc32=0123abcd

struct ClearedTrips {
  std::array<std::int64_t, 8> utc_s{};  ///< 0 = none
  bool unreadable = false;              ///< the file exists and is malformed

  [[nodiscard]] bool has(std::int64_t trip_utc_s) const;
  void add(std::int64_t trip_utc_s);
};

using ClearanceText = FixedText<255>;
ClearanceText format_cleared(const ClearedTrips& cleared);
/// Any text that `format_cleared` does not write is unreadable.
ClearedTrips parse_cleared(std::string_view text);
/// Reads `path`; without file or path nothing is cleared. Allocates nothing.
ClearedTrips read_cleared(const char* path);

inline constexpr std::string_view kClearedFileName = "cleared";

/// Whether the trip of this time was cleared. Allocates nothing.
bool is_trip_cleared(const StateFilePaths& paths, std::int64_t trip_utc_s);

/// Adds the trip to this file and syncs it. False with errno set.
bool clear_trip_of(const char* path, std::int64_t trip_utc_s);

struct RestoredState {
  CycleRecord before{};        ///< newest record of both logs, or empty
  std::optional<Trip> trip{};  ///< in a log and not cleared
  std::string unknown;         ///< why earlier state is unreadable, or empty
};

/// Trip for a start with unreadable earlier state, which may hide a trip. A known trip stays.
inline std::optional<Trip> trip_without_state(const RestoredState& restored,
                                              std::int64_t now_utc_s) {
  if (restored.unknown.empty() || restored.trip) return restored.trip;
  return Trip{.reason = Reason::kStateLost, .utc_s = now_utc_s};
}

/// Trip in the newest record of either ring that is not cleared.
std::optional<Trip> standing_trip(const RingLog& ring, const RingLog& run_ring,
                                  const StateFilePaths& cleared);

/// `published_number`: newest record in a stored status; 0 = none.
RestoredState restore_state(const RingLog& ring, const RingLog& run_ring,
                            std::uint64_t published_number, const StateFilePaths& cleared);

}  // namespace bess
