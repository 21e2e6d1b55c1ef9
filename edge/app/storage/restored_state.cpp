#include "edge/app/storage/restored_state.h"

#include <algorithm>
#include <cerrno>
#include <charconv>

#include "edge/records/log/atomic_file.h"
#include "edge/records/log/text_buffer.h"
#include "shared/host/text.h"

namespace bess {

namespace {

constexpr std::string_view kHead = "bess-cleared 1";

constexpr ClearedTrips kUnreadable{.unreadable = true};

/// Older versions wrote only the time.
bool parse_older(std::string_view text, ClearedTrips& cleared) {
  if (!text.ends_with('\n')) return false;
  return read_number(text.substr(0, text.size() - 1), cleared.utc_s.front());
}

}  // namespace

bool ClearedTrips::has(std::int64_t trip_utc_s) const {
  return trip_utc_s != 0 && std::find(utc_s.begin(), utc_s.end(), trip_utc_s) != utc_s.end();
}

void ClearedTrips::add(std::int64_t trip_utc_s) {
  std::copy_backward(utc_s.begin(), utc_s.end() - 1, utc_s.end());
  utc_s.front() = trip_utc_s;
}

ClearanceText format_cleared(const ClearedTrips& cleared) {
  char storage[256];
  TextBuffer text(storage);
  text.add("%s", kHead.data());
  for (const std::int64_t utc_s : cleared.utc_s) {
    if (utc_s != 0) text.add(" %lld", static_cast<long long>(utc_s));
  }
  text.add("%s", checksum_end(text.view(), kLineChecksum).c_str());
  return {text.view()};
}

ClearedTrips parse_cleared(std::string_view text) {
  if (ClearedTrips older; parse_older(text, older)) return older;
  if (!text.starts_with(kHead) || check_text(text, kLineChecksum) != ChecksumState::kIntact) {
    return kUnreadable;
  }
  const std::string_view line = without_checksum(text, kLineChecksum);
  const char* const end = line.data() + line.size();
  ClearedTrips cleared;
  const char* at = line.data() + kHead.size();
  for (std::int64_t& utc_s : cleared.utc_s) {
    if (at >= end) break;
    const auto read = std::from_chars(at + 1, end, utc_s);
    if (read.ec != std::errc{}) return kUnreadable;
    at = read.ptr;
  }
  // Checks all other characters and the checksum: formatting must give the same text.
  return format_cleared(cleared) == text ? cleared : kUnreadable;
}

ClearedTrips read_cleared(const char* path) {
  char text[256];
  if (*path == '\0') return {};
  const ssize_t size = read_beginning(path, text, SymlinkPolicy::kRefused);
  if (size < 0) return errno == ENOENT ? ClearedTrips{} : kUnreadable;
  return parse_cleared({text, static_cast<std::size_t>(size)});
}

bool is_trip_cleared(const StateFilePaths& paths, std::int64_t trip_utc_s) {
  return read_cleared(paths.state.c_str()).has(trip_utc_s) ||
         read_cleared(paths.run.c_str()).has(trip_utc_s);
}

bool clear_trip_of(const char* path, std::int64_t trip_utc_s) {
  ClearedTrips cleared = read_cleared(path);
  if (cleared.unreadable) cleared = {};
  cleared.add(trip_utc_s);
  return replace_file_durably(path, format_cleared(cleared).view());
}

namespace {

std::string why_none_is_known(const RingLog& ring, std::uint64_t published_number) {
  if (!ring.is_open()) return "the decision log can be neither read nor created";
  if (ring.damage().is_any()) return "the decision log is unreadable";
  if (published_number == 0) return "";  // a new battery
  return "the decision log is missing, although a controller has run here";
}

std::string why_unknown(const RingLog& ring, const RingLog& run_ring,
                        std::uint64_t published_number) {
  const std::uint64_t newest = std::max(ring.newest_number(), run_ring.newest_number());
  if (newest == 0) return why_none_is_known(ring, published_number);
  // One lost record is harmless; several may hide a trip.
  const bool knows_more = run_ring.newest_number() > ring.newest_number();
  if (!knows_more && ring.damage().newest_lost > 1) {
    return "the newest records of the decision log are lost, up to " +
           std::to_string(ring.damage().newest_lost);
  }
  if (published_number > newest + 1) {
    return "the decision log ends with record " + std::to_string(newest) +
           ", although there was a record " + std::to_string(published_number);
  }
  return "";
}

}  // namespace

std::optional<Trip> standing_trip(const RingLog& ring, const RingLog& run_ring,
                                  const StateFilePaths& cleared) {
  const bool run_is_newer = run_ring.newest_number() > ring.newest_number();
  const RingLog& newer = run_is_newer ? run_ring : ring;
  const RingLog& other = run_is_newer ? ring : run_ring;
  CycleRecord record;
  for (const RingLog* log : {&newer, &other}) {
    const bool is_tripped =
        log->newest(record) && record.is_tripped && !is_trip_cleared(cleared, record.trip.utc_s);
    if (is_tripped) return record.trip;
  }
  return std::nullopt;
}

RestoredState restore_state(const RingLog& ring, const RingLog& run_ring,
                            std::uint64_t published_number, const StateFilePaths& cleared) {
  RestoredState restored;
  const bool run_is_newer = run_ring.newest_number() > ring.newest_number();
  static_cast<void>((run_is_newer ? run_ring : ring).newest(restored.before));
  restored.trip = standing_trip(ring, run_ring, cleared);
  restored.unknown = why_unknown(ring, run_ring, published_number);
  return restored;
}

}  // namespace bess
