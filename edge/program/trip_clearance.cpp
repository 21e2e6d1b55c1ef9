#include "edge/program/trip_clearance.h"

#include <charconv>
#include <cstdio>
#include <string_view>

#include "edge/log/whole_file.h"

namespace bess {

FixedText<639> trip_clearance_path(const EdgeConfig& config) {
  return state_file(config, "cleared");
}

bool clear_trip_of(const char* path, std::int64_t trip_utc_s) {
  char text[32];
  const int size = std::snprintf(text, sizeof text, "%lld\n", static_cast<long long>(trip_utc_s));
  return replace_file_durably(path, {text, static_cast<std::size_t>(size)});
}

bool is_trip_cleared(const char* path, std::int64_t trip_utc_s) {
  char text[32];
  const ssize_t size = read_beginning(path, text, Links::kRefused);
  std::int64_t cleared_utc_s = 0;
  const auto [end, error] = std::from_chars(text, text + (size > 0 ? size : 0), cleared_utc_s);
  return error == std::errc{} && cleared_utc_s == trip_utc_s;
}

Trip standing_trip(const RingLog& ring, const EdgeConfig& config) {
  CycleRecord newest;
  if (!ring.read(ring.newest_number(), newest) || !newest.is_tripped) return {};
  const bool is_cleared = is_trip_cleared(trip_clearance_path(config).c_str(), newest.trip.utc_s);
  return is_cleared ? Trip{} : newest.trip;
}

}  // namespace bess
