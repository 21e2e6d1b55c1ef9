#include "edge/log/ring_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "shared/crc32.h"

namespace bess {
namespace {

constexpr std::int64_t kHeaderBytes = 4'096;
constexpr char kMagic[8] = {'B', 'E', 'S', 'S', 'R', 'I', 'N', 'G'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderUsedBytes = 28;  // magic, version, record bytes, capacity, CRC

void put(std::uint8_t* bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint64_t take(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

void fill_header(std::uint8_t (&header)[kHeaderUsedBytes], std::size_t record_bytes,
                 std::int64_t capacity) {
  std::memcpy(header, kMagic, sizeof kMagic);
  put(header + 8, kVersion, 4);
  put(header + 12, record_bytes, 4);
  put(header + 16, static_cast<std::uint64_t>(capacity), 8);
  Crc32 crc;
  crc.add_bytes(header, 24);
  put(header + 24, crc.value(), 4);
}

}  // namespace

RingLog::~RingLog() { close_file(); }

void RingLog::close_file() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

std::int64_t RingLog::offset_of(std::uint64_t number) const {
  return kHeaderBytes + static_cast<std::int64_t>(number % static_cast<std::uint64_t>(capacity_)) *
                            static_cast<std::int64_t>(record_bytes_);
}

bool RingLog::open(const char* path, std::int64_t capacity, FileMessage& error) {
  fd_ = ::open(path, O_RDWR | O_CLOEXEC);
  if (fd_ < 0 && errno == EROFS) return learn_newest(path, error);
  if (fd_ < 0 && errno != ENOENT) return fail_with_errno(path, "cannot open the log", error);
  const bool is_sound = fd_ >= 0 && read_header();
  if (is_sound) find_newest();
  const bool takes_records = is_sound && record_bytes_ == kRecordBytes;
  if (takes_records && capacity_ == capacity) return true;
  const std::int64_t capacity_before = std::exchange(capacity_, capacity);
  if (replace(path, error)) return true;
  if (takes_records && is_disk_trouble(errno)) {
    capacity_ = capacity_before;
    return true;
  }
  close_file();
  return false;
}

/// On a read-only disk nothing can be added, but the counters of earlier runs are known. Always false.
bool RingLog::learn_newest(const char* path, FileMessage& error) {
  fd_ = ::open(path, O_RDONLY | O_CLOEXEC);
  if (fd_ >= 0 && read_header()) find_newest();
  close_file();
  errno = EROFS;
  return fail_with_errno(path, "cannot open the log", error);
}

bool RingLog::open_to_read(const char* path, FileMessage& error) {
  fd_ = ::open(path, O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) return fail_with_errno(path, "cannot open the log", error);
  if (!read_header()) {
    char line[700];
    std::snprintf(line, sizeof line,
                  "%s: is not a decision log of this program; the next start sets it aside", path);
    static_cast<void>(error.assign(line));
    return false;
  }
  find_newest();
  return true;
}

/// The new file is there as a whole before the old one loses its name.
bool RingLog::replace(const char* path, FileMessage& error) {
  char beside[640];
  std::snprintf(beside, sizeof beside, "%s.new", path);
  const int made = make_whole(beside);
  if (made < 0) return fail_with_errno(beside, "cannot make the log", error);
  char aside[640];
  std::snprintf(aside, sizeof aside, "%s.old", path);
  const bool is_free = fd_ < 0 || rename(path, aside) == 0;
  if (!is_free || rename(beside, path) != 0) {
    fail_with_errno(path, "cannot set aside the log", error);
    close(made);
    unlink(beside);
    return false;
  }
  close_file();
  fd_ = made;
  record_bytes_ = kRecordBytes;
  sync_folder_of(path);
  return true;
}

/// At its full size and with its header, on the disk. Negative with errno set, and nothing left.
int RingLog::make_whole(const char* path) const {
  const int made = make_afresh(path);
  if (made < 0) return -1;
  const std::int64_t size = kHeaderBytes + capacity_ * static_cast<std::int64_t>(kRecordBytes);
  int cause = posix_fallocate(made, 0, size);  // a full disk must show now, not in a month
  errno = ENOSPC;                              // what a short write means
  if (cause == 0 && write_header(made) && fsync(made) == 0) return made;
  if (cause == 0) cause = errno;
  close(made);
  unlink(path);
  errno = cause;
  return -1;
}

bool RingLog::write_header(int fd) const {
  std::uint8_t header[kHeaderUsedBytes];
  fill_header(header, kRecordBytes, capacity_);
  return pwrite(fd, header, sizeof header, 0) == static_cast<ssize_t>(sizeof header);
}

bool RingLog::read_header() {
  std::uint8_t header[kHeaderUsedBytes];
  if (pread(fd_, header, sizeof header, 0) != static_cast<ssize_t>(sizeof header)) return false;
  const auto capacity = static_cast<std::int64_t>(take(header + 16, 8));
  record_bytes_ = take(header + 12, 4) == kOlderRecordBytes ? kOlderRecordBytes : kRecordBytes;
  std::uint8_t expected[kHeaderUsedBytes];
  fill_header(expected, record_bytes_, capacity);
  if (capacity < 1 || std::memcmp(header, expected, sizeof header) != 0) return false;
  struct stat info {};
  const bool is_file = fstat(fd_, &info) == 0;
  capacity_ = capacity;
  return is_file &&
         capacity <= (INT64_MAX - kHeaderBytes) / static_cast<std::int64_t>(kRecordBytes);
}

void RingLog::find_newest() {
  constexpr std::size_t kChunkBytes = 64 * kRecordBytes;
  std::uint8_t chunk[kChunkBytes];
  CycleRecord record;
  std::int64_t offset = kHeaderBytes;
  for (std::int64_t slot = 0; slot < capacity_;) {
    const ssize_t bytes = pread(fd_, chunk, sizeof chunk, offset);
    const auto count = bytes > 0 ? static_cast<std::size_t>(bytes) / record_bytes_ : 0;
    if (count == 0) return;  // shorter than it should be: what is there counts
    for (std::size_t i = 0; i < count && slot < capacity_; ++i, ++slot) {
      std::uint64_t number = 0;
      const bool whole =
          decode_record({chunk + i * record_bytes_, record_bytes_}, record, number) &&
          number % static_cast<std::uint64_t>(capacity_) == static_cast<std::uint64_t>(slot);
      if (!whole || number <= newest_number_) continue;
      newest_number_ = number;
      newest_ = record;
    }
    offset += static_cast<std::int64_t>(count * record_bytes_);
  }
}

bool RingLog::append(const CycleRecord& record) {
  RecordBytes bytes;
  const std::uint64_t number = newest_number_ + 1;
  encode_record(record, number, bytes);
  const ssize_t written = pwrite(fd_, bytes.data(), bytes.size(), offset_of(number));
  if (written != static_cast<ssize_t>(bytes.size()) || fdatasync(fd_) != 0) return false;
  newest_number_ = number;
  newest_ = record;
  return true;
}

bool RingLog::newest(CycleRecord& record) const {
  if (newest_number_ == 0) return false;
  record = newest_;
  return true;
}

std::uint64_t RingLog::oldest_number() const {
  const auto capacity = static_cast<std::uint64_t>(capacity_);
  return newest_number_ > capacity ? newest_number_ - capacity + 1 : 1;
}

bool RingLog::read(std::uint64_t number, CycleRecord& record) const {
  RecordBytes bytes;
  const ssize_t got = pread(fd_, bytes.data(), record_bytes_, offset_of(number));
  std::uint64_t found = 0;
  return got == static_cast<ssize_t>(record_bytes_) &&
         decode_record(std::span(bytes).first(record_bytes_), record, found) && found == number;
}

}  // namespace bess
