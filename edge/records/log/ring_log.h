// The decision log on disk: a ring of fixed-size records in one file of constant size. Written by
// the log thread of bess-edge, read by `bess-edge log` and `bess-edge status` while it is being
// written.
//
//   0     header: "BESSRING", version, bytes of a record, capacity, CRC-32
//   2048  the header again; zeros up to 4096
//   4096  capacity records of 512 bytes (record_codec.h); record number n lies in slot n % capacity
//
// Power cuts: the file is made beside its place and renamed, so its header is never half written; a
// record overwrites the oldest one and carries a CRC, so a torn one costs itself and nothing else.
// A card that forgets: a broken header is taken from its second copy, or found from the records
// themselves, whose numbers and places prove it; what cannot be read is passed over and counted.
// Nothing here allocates.
#pragma once

#include <cstdint>
#include <span>

#include "edge/core/control/control_types.h"
#include "edge/records/log/record_codec.h"
#include "edge/records/log/text_buffer.h"
#include "edge/records/log/whole_file.h"

namespace bess {

// What an opening of the decision log found lost: a card that dies forgets bytes here and there.

struct RingDamage {
  enum class Header { kSound, kFromCopy, kFromRecords };

  Header header = Header::kSound;
  std::int64_t broken_records = 0;   ///< slots that hold neither a record nor nothing
  std::int64_t missing_records = 0;  ///< slots behind the end of the file
  std::int64_t newest_lost = 0;  ///< of both, right behind the newest that is left: perhaps newer
  bool is_set_aside = false;     ///< nothing of the file could be understood
  bool was_absent = false;       ///< no file: not a loss by itself

  [[nodiscard]] bool is_any() const {
    return header != Header::kSound || broken_records > 0 || missing_records > 0 || is_set_aside;
  }
};

/// One line for the journal: what was lost and what was done; only where there is any.
void describe_damage(const RingDamage& damage, const char* path, TextBuffer& line);

class RingLog {
 public:
  RingLog() = default;
  RingLog(const RingLog&) = delete;
  RingLog& operator=(const RingLog&) = delete;
  ~RingLog();

  /// For writing. A missing file is made; one of another capacity, of smaller records or of which
  /// nothing can be understood is set aside as "PATH.old", its numbers and newest record are taken
  /// over as far as they can be read. Where the disk has no room for another one, a sound log goes
  /// on at the size that it has. On a read-only disk it fails, and what is in the log can be read
  /// all the same. False with one line and errno; may be tried again.
  bool open(const char* path, std::int64_t capacity, FileMessage& error);
  /// For reading, beside a writer. Damage is counted only where the newest record cannot be told
  /// without.
  bool open_to_read(const char* path, FileMessage& error);

  /// For what it was opened for.
  /// Whether the file that is open is still the one of that name: a disk may be unmounted below it,
  /// or mounted over it.
  [[nodiscard]] bool is_at(const char* path) const;
  [[nodiscard]] bool is_open() const { return fd_ >= 0 && !is_read_only_; }
  [[nodiscard]] std::int64_t capacity() const { return capacity_; }

  /// Writes behind the newest record and waits for the disk. False when the disk refused; the next
  /// call tries the same slot again.
  bool append(const CycleRecord& record) { return append(record, newest_number_ + 1); }
  /// The same under a later number: the ones between are left out.
  bool append(const CycleRecord& record, std::uint64_t number);

  /// The newest whole record that was there at opening or was appended since; false = none.
  bool newest(CycleRecord& record) const;
  /// Numbers of the records that may be read, from 1; newest 0 = empty.
  [[nodiscard]] std::uint64_t newest_number() const { return newest_number_; }
  [[nodiscard]] std::uint64_t oldest_number() const;
  /// False when that record was never written, is torn, or has been overwritten.
  bool read(std::uint64_t number, CycleRecord& record) const;
  /// What was lost of the file that the last `open` found.
  [[nodiscard]] const RingDamage& damage() const { return damage_; }

 private:
  struct Geometry {
    std::size_t record_bytes = 0;
    std::int64_t capacity = 0;
  };
  struct Scan {
    std::int64_t whole = 0;      ///< records in their places
    std::int64_t misplaced = 0;  ///< records in others' places
    std::int64_t broken = 0;     ///< neither a record nor never written
    std::int64_t missing = 0;    ///< behind the end of the file
  };

  bool open_read_only(const char* path, std::int64_t capacity, FileMessage& error);
  void set_aside(const char* path);
  bool replace(const char* path, FileMessage& error);
  int make_whole(const char* path) const;
  bool understand(std::int64_t likely_capacity);
  bool read_header(std::int64_t offset);
  bool find_geometry(std::int64_t likely_capacity);
  bool fits(const Geometry& geometry);
  void mend();
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
  bool is_read_only_ = false;                ///< although it was opened for writing
  std::size_t record_bytes_ = kRecordBytes;  ///< of the file that is open
  std::int64_t capacity_ = 0;
  std::uint64_t newest_number_ = 0;
  CycleRecord newest_{};
  RingDamage damage_{};
};

}  // namespace bess
