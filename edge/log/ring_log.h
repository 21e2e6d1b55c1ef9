// The decision log on disk: a ring of fixed-size records in one file of constant size. Written by
// the log thread of bess-edge, read by `bess-edge log` and `bess-edge status` while it is being
// written.
//
//   0     header: "BESSRING", version, bytes of a record, capacity, CRC-32; padded to 4096 bytes
//   4096  capacity records of 512 bytes (record_codec.h); record number n lies in slot n % capacity
//
// Power cuts: the file is made beside its place and renamed, so its header is never half written; a
// record overwrites the oldest one and carries a CRC, so a torn one costs itself and nothing else.
// Nothing here allocates.
#pragma once

#include <cstdint>

#include "edge/control/control_types.h"
#include "edge/log/record_codec.h"
#include "edge/log/whole_file.h"

namespace bess {

class RingLog {
 public:
  RingLog() = default;
  RingLog(const RingLog&) = delete;
  RingLog& operator=(const RingLog&) = delete;
  ~RingLog();

  /// For writing. A missing file is made; one of another capacity, of smaller records or without a
  /// sound header is set aside as "PATH.old", its numbers and newest record are taken over as far as
  /// they can be read. Where the disk has no room for another one, a sound log goes on at the size
  /// that it has. False with one line and errno; may be tried again.
  bool open(const char* path, std::int64_t capacity, FileMessage& error);
  /// For reading, beside a writer.
  bool open_to_read(const char* path, FileMessage& error);

  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  [[nodiscard]] std::int64_t capacity() const { return capacity_; }

  /// Writes behind the newest record and waits for the disk. False when the disk refused; the next
  /// call tries the same slot again.
  bool append(const CycleRecord& record);

  /// The newest whole record that was there at opening or was appended since; false = none.
  bool newest(CycleRecord& record) const;
  /// Numbers of the records that may be read, from 1; newest 0 = empty.
  [[nodiscard]] std::uint64_t newest_number() const { return newest_number_; }
  [[nodiscard]] std::uint64_t oldest_number() const;
  /// False when that record was never written, is torn, or has been overwritten.
  bool read(std::uint64_t number, CycleRecord& record) const;

 private:
  bool learn_newest(const char* path, FileMessage& error);
  bool replace(const char* path, FileMessage& error);
  int make_whole(const char* path) const;
  bool read_header();
  bool write_header(int fd) const;
  void find_newest();
  [[nodiscard]] std::int64_t offset_of(std::uint64_t number) const;
  void close_file();

  int fd_ = -1;
  std::size_t record_bytes_ = kRecordBytes;  ///< of the file that is open
  std::int64_t capacity_ = 0;
  std::uint64_t newest_number_ = 0;
  CycleRecord newest_{};
};

}  // namespace bess
