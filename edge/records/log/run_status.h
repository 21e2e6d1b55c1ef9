// How things are now, for other programs: who runs, what has happened since the start, the last
// cycle. Formatted as JSON for `bess-edge status` and as a text for Prometheus (node exporter's
// textfile collector). Filled and formatted by the log thread: bounded buffers, no heap.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/core/control/control_types.h"
#include "edge/records/log/text_buffer.h"
#include "shared/fixed_text.h"

namespace bess {

/// What the state folder's device tells of its wear, and its file system of itself; read at the
/// start.
struct CardWear {
  int used_life_percent = 0;  ///< of an eMMC, the upper end of its tenth; 0 = not told
  int spare_level = 0;  ///< its pre_eol_info: 1 normal, 2 four fifths of the spare blocks are used,
                        ///< 3 nine tenths; 0 = not told
  std::int64_t file_system_errors =
      -1;  ///< that the kernel has counted (ext4); negative = not told
};

/// Beyond it the card should be replaced.
inline constexpr int kUsedLifePercentMax = 90;

/// What does not change while the process runs.
struct RunIdentity {
  FixedText<63> name;  ///< [battery] name
  FixedText<31> version;
  std::uint32_t student_hash = 0;
  FixedText<255> student_provenance;
  FixedText<10> trained_from, trained_until;  ///< local dates; empty: not known
  FixedText<7> context = "month";             ///< what its context class is made from, or "level"
  FixedText<31> map;
  FixedText<31> variant;
  StaticVector<FixedText<31>, 48> point_names;  ///< of the map, as records count them
  FixedText<159> battery;                       ///< "127.0.0.1:502 unit 85"
  bool control = false;
  pid_t pid = 0;
  std::int64_t start_utc_s = 0;
  std::int32_t cadence_ms = 120'000;  ///< wall time from one cycle to the next
  CardWear wear;
};

/// What has happened since the start.
struct RunTotals {
  std::int64_t cycles = 0;
  std::array<std::int64_t, kReasonCount> cycles_by_reason{};
  std::int64_t written_orders = 0;
  std::int64_t battery_failures = 0;   ///< cycles whose battery status was not ok
  std::int64_t price_failures = 0;     ///< cycles whose last price request was not ok
  std::int64_t records_dropped = 0;    ///< not logged, because the disk was too slow
  std::int64_t disk_failures = 0;      ///< records that a log file refused
  bool disk_is_slow = false;           ///< records were dropped since the last one kept
  bool disk_is_failing = false;        ///< the last record could not be written everywhere
  bool run_folder_is_failing = false;  ///< nor what goes to the run folder
  std::uint64_t log_number = 0;        ///< of the newest record that this status knows
  CycleRecord last{};

  void count(const CycleRecord& record);
};

/// How a run is, in one piece: what bess-edge's own commands read. For other programs it is
/// formatted as JSON and for Prometheus.
struct RunStatus {
  RunIdentity identity{};
  RunTotals totals{};
  std::int64_t written_monotonic_ms = 0;
};

/// Raised when a member of RunStatus is added, moved or removed.
inline constexpr std::uint32_t kStatusLayout = 1;

/// The status on disk: one of another layout, a torn or a damaged one is not read.
struct StoredStatus {
  std::uint32_t layout = 0;
  std::uint32_t bytes = 0;
  std::uint64_t crc = 0;  ///< of `status`
  RunStatus status{};
};
/// status.bin beside status.json.
FixedText<511> stored_status_path(const FixedText<511>& status_json);
/// False with errno set.
bool write_status(const char* path, StoredStatus& stored);
enum class StatusFile : std::uint8_t { kAbsent, kDamaged, kRead };
StatusFile read_status(const char* path, RunStatus& status);

inline constexpr std::size_t kStatusBytes = 6'144;
inline constexpr std::size_t kMetricsBytes = 24'576;

/// Both end with a checksum of what stands before (whole_file.h): as JSON's last member, as a
/// comment.
void format_status_json(const RunStatus& status, TextBuffer& json);
void format_prometheus(const RunStatus& status, TextBuffer& text);

}  // namespace bess
