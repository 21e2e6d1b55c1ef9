// Run status for other programs: identity, totals, last control cycle. Formatted as JSON for
// `bess-edge status` and as text for the textfile collector of the Prometheus node exporter. Filled
// and formatted by the log thread: bounded buffers, no heap.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/core/control/control_types.h"
#include "edge/records/log/text_buffer.h"
#include "shared/fixed_text.h"

namespace bess {

/// Wear of the state folder's device and errors of its file system, read at the start.
struct StorageWear {
  int used_life_percent = 0;  ///< of an eMMC, rounded up to tenths; 0 = not reported
  int spare_level = 0;        ///< pre_eol_info: 1 normal, 2: 80 % of the spare blocks used,
                              ///< 3: 90 %; 0 = not reported
  std::int64_t file_system_errors = -1;  ///< counted by the kernel (ext4); negative = not reported
};

/// Above this the storage should be replaced.
inline constexpr int kUsedLifePercentMax = 90;

/// Constants of a run.
struct RunIdentity {
  FixedText<63> name;  ///< [battery] name
  FixedText<31> version;
  std::uint32_t student_hash = 0;
  FixedText<255> student_provenance;
  FixedText<10> trained_from, trained_until;  ///< local dates; empty: unknown
  FixedText<7> context = "month";             ///< kind of the context class
  FixedText<31> map;
  FixedText<31> variant;
  StaticVector<FixedText<31>, 48> point_names;  ///< of the map, in the order of records
  FixedText<159> battery;                       ///< "127.0.0.1:502 unit 85"
  bool control = false;
  pid_t pid = 0;
  std::int64_t start_utc_s = 0;
  std::int32_t cadence_ms = 120'000;  ///< wall time of a control cycle
  StorageWear wear;
};

/// Totals since the start.
struct RunTotals {
  std::int64_t cycles = 0;
  std::array<std::int64_t, kReasonCount> cycles_by_reason{};
  std::int64_t written_orders = 0;
  std::int64_t battery_failures = 0;     ///< control cycles whose battery status was not ok
  std::int64_t price_failures = 0;       ///< control cycles whose last price request was not ok
  std::int64_t reason_since_utc_s = 0;   ///< first control cycle in a row with the last reason
  std::int64_t battery_since_utc_s = 0;  ///< ... with the last battery status
  std::int64_t price_since_utc_s = 0;    ///< ... with the last price status
  std::int64_t records_dropped = 0;      ///< because the disk was too slow
  std::int64_t disk_failures = 0;        ///< failed writes of records to a log file
  bool disk_is_slow = false;             ///< records dropped since the last stored one
  bool disk_is_failing = false;          ///< a write of the last record failed
  bool run_folder_is_failing = false;    ///< a write to the run folder failed
  std::uint64_t log_number = 0;          ///< of the newest record in this status
  CycleRecord last{};

  void count(const CycleRecord& record);
};

/// Status of a run, read by the commands of bess-edge.
struct RunStatus {
  RunIdentity identity{};
  RunTotals totals{};
  std::int64_t written_monotonic_ms = 0;
};

/// Increase when a member of RunStatus is added, moved or removed.
inline constexpr std::uint32_t kStatusLayout = 2;

/// Status on disk. Another layout, or a torn or damaged file, is rejected.
struct StoredStatus {
  std::uint32_t layout = 0;
  std::uint32_t bytes = 0;
  std::uint64_t crc = 0;  ///< of `status`
  RunStatus status{};
};
/// status.bin in the folder of status.json.
FixedText<511> stored_status_path(const FixedText<511>& status_json);
/// False with errno set.
bool write_status(const char* path, StoredStatus& stored);
enum class StatusFile : std::uint8_t { kAbsent, kDamaged, kRead };
StatusFile read_status(const char* path, RunStatus& status);

inline constexpr std::size_t kStatusBytes = 6'144;
inline constexpr std::size_t kMetricsBytes = 24'576;

/// Both end with a checksum of the preceding text (atomic_file.h): last JSON member, comment.
void format_status_json(const RunStatus& status, TextBuffer& json);
void format_prometheus(const RunStatus& status, TextBuffer& text);

}  // namespace bess
