// Decision log on disk: a ring of fixed-size records in one file of constant size. Written by the
// log thread of bess-edge, read at the same time by `bess-edge log` and `bess-edge status`.
//
//   0     header: "BESSRING", version, bytes of a record, capacity, CRC-32
//   2048  the header again; zeros up to 4096
//   4096  capacity records of 512 bytes (record_codec.h); record number n is in slot n % capacity
//
// Power cuts: a new file is written completely, then renamed; a record overwrites the oldest one
// and has a CRC, so a torn record affects no other. Lost bytes: a broken header is restored from
// its copy, or from numbers and slots of the records; unreadable records are skipped and counted.
// Nothing here allocates.
#pragma once

#include <cstdint>
#include <span>

#include "edge/core/control/control_types.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/record_codec.h"
#include "edge/records/log/text_buffer.h"

namespace bess {

/// Damage found when opening the decision log, as by a failing card.
struct RingDamage {
  enum class Header { kSound, kFromCopy, kFromRecords };

  Header header = Header::kSound;
  std::int64_t broken_records = 0;   ///< slots that are neither intact nor empty
  std::int64_t missing_records = 0;  ///< slots beyond the end of the file
  std::int64_t newest_lost = 0;      ///< of both, directly after the newest intact record
  bool is_set_aside = false;         ///< the file was unreadable
  bool is_read_only = false;         ///< and stays, because the disk is read-only

  [[nodiscard]] bool is_any() const {
    return header != Header::kSound || broken_records > 0 || missing_records > 0 || is_set_aside;
  }
};

/// One journal line with damage and repair; only with damage.
void describe_damage(const RingDamage& damage, const char* path, TextBuffer& line);

class RingLog {
 public:
  RingLog() = default;
  RingLog(const RingLog&) = delete;
  RingLog& operator=(const RingLog&) = delete;
  ~RingLog();

  /// For writing. Creates a missing file. A file of another capacity, with smaller records, or
  /// unreadable is renamed to "PATH.old"; numbers and newest record are kept as far as readable.
  /// Without room for a new file an intact log keeps its size. On a read-only disk it fails, but
  /// the log can be read. False with one line and errno; may be retried.
  bool open(const char* path, std::int64_t capacity, FileMessage& error);
  /// For reading, at the same time as a writer. Damage is counted only if the newest record cannot
  /// be found otherwise.
  bool open_to_read(const char* path, FileMessage& error);

  /// Whether the open file is still the one at `path`: its disk may have been unmounted or covered.
  [[nodiscard]] bool is_at(const char* path) const;
  [[nodiscard]] bool is_open() const { return fd_ >= 0 && !is_read_only_; }
  [[nodiscard]] std::int64_t capacity() const { return capacity_; }

  /// Appends after the newest record and syncs. False on a disk error; the next call retries the
  /// same slot.
  bool append(const CycleRecord& record) { return append(record, newest_number_ + 1); }
  /// The same with a later number; the numbers between stay unused.
  bool append(const CycleRecord& record, std::uint64_t number);

  /// Newest intact record; false = none.
  bool newest(CycleRecord& record) const;
  /// Numbers of the readable records, from 1; newest 0 = empty.
  [[nodiscard]] std::uint64_t newest_number() const { return newest_number_; }
  [[nodiscard]] std::uint64_t oldest_number() const;
  /// False for a record that was never written, is torn, or was overwritten.
  bool read(std::uint64_t number, CycleRecord& record) const;
  /// Damage found by the last `open`.
  [[nodiscard]] const RingDamage& damage() const { return damage_; }

 private:
  struct Geometry {
    std::size_t record_bytes = 0;
    std::int64_t capacity = 0;
  };
  struct Scan {
    std::int64_t whole = 0;      ///< records in their slots
    std::int64_t misplaced = 0;  ///< records in other slots
    std::int64_t broken = 0;     ///< neither intact nor empty
    std::int64_t missing = 0;    ///< beyond the end of the file
  };

  bool open_read_only(const char* path, std::int64_t capacity, FileMessage& error);
  void set_aside(const char* path);
  bool replace(const char* path, FileMessage& error);
  int make_whole(const char* path) const;
  bool understand(std::int64_t likely_capacity);
  bool read_header(std::int64_t offset);
  bool find_geometry(std::int64_t likely_capacity);
  bool fits(const Geometry& geometry);
  void repair();
  bool write_header(int fd) const;
  bool write_newest(int fd) const;
  Scan find_newest();
  bool find_newest_by_number();
  void look_at(std::span<const std::uint8_t> stored, std::int64_t slot, Scan& scan);
  [[nodiscard]] bool is_lost_at(std::uint64_t number) const;
  [[nodiscard]] std::int64_t offset_of(std::uint64_t number) const;
  [[nodiscard]] std::int64_t file_bytes() const;
  void close_file();

  int fd_ = -1;
  bool is_read_only_ = false;                ///< although opened for writing
  std::size_t record_bytes_ = kRecordBytes;  ///< of the open file
  std::int64_t capacity_ = 0;
  std::uint64_t newest_number_ = 0;
  CycleRecord newest_{};
  RingDamage damage_{};
};

}  // namespace bess
