#include "edge/records/log/ring_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>

#include "shared/crc32.h"

namespace bess {

void describe_damage(const RingDamage& damage, const char* path, TextBuffer& line) {
  line.add("%s is damaged", path);
  if (damage.is_set_aside) {
    line.add(damage.is_read_only
                 ? ": unreadable; the first start on a writable disk renames it to .old"
                 : ": unreadable; renamed to .old, starting a new log");
    return;
  }
  if (damage.header == RingDamage::Header::kFromCopy) {
    line.add("; header broken, its copy is used");
  } else if (damage.header == RingDamage::Header::kFromRecords) {
    line.add("; header and copy broken, rebuilt from the records");
  }
  const auto broken = static_cast<long long>(damage.broken_records);
  if (broken > 0) line.add("; %lld %s lost", broken, broken == 1 ? "record is" : "records are");
  if (damage.missing_records > 0) {
    line.add("; end truncated: %lld records are missing",
             static_cast<long long>(damage.missing_records));
  }
  if (damage.newest_lost > 0) {
    line.add("; up to %lld of the newest records lost: the last intact one is used",
             static_cast<long long>(damage.newest_lost));
  }
}

namespace {

constexpr std::int64_t kHeaderBytes = 4'096;
constexpr std::int64_t kHeaderCopyAt = 2'048;
constexpr char kMagic[8] = {'B', 'E', 'S', 'S', 'R', 'I', 'N', 'G'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderUsedBytes = 28;  // magic, version, record bytes, capacity, CRC

void fill_header(std::uint8_t (&header)[kHeaderUsedBytes], std::size_t record_bytes,
                 std::int64_t capacity) {
  std::memcpy(header, kMagic, sizeof kMagic);
  put_bytes(kVersion, 4, header + 8);
  put_bytes(record_bytes, 4, header + 12);
  put_bytes(static_cast<std::uint64_t>(capacity), 8, header + 16);
  put_bytes(crc32_of(header, 24), 4, header + 24);
}

/// Neither intact (possibly of a later version) nor never written.
bool is_broken(std::span<const std::uint8_t> stored) {
  return !is_intact(stored) &&
         std::any_of(stored.begin(), stored.end(), [](std::uint8_t byte) { return byte != 0; });
}

FixedText<643> path_with(const char* path, const char* ending) {
  char text[644];
  std::snprintf(text, sizeof text, "%s%s", path, ending);
  return {text};
}

}  // namespace

RingLog::~RingLog() { close_file(); }

void RingLog::close_file() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
  is_read_only_ = false;
}

std::int64_t RingLog::offset_of(std::uint64_t number) const {
  return kHeaderBytes + static_cast<std::int64_t>(number % static_cast<std::uint64_t>(capacity_)) *
                            static_cast<std::int64_t>(record_bytes_);
}

std::int64_t RingLog::file_bytes() const {
  return kHeaderBytes + capacity_ * static_cast<std::int64_t>(record_bytes_);
}

bool RingLog::open(const char* path, std::int64_t capacity, FileMessage& error) {
  damage_ = {};
  const int opened = ::open(path, O_RDWR | O_CLOEXEC);
  if (opened < 0 && errno == EROFS) return open_read_only(path, capacity, error);
  if (opened < 0 && errno != ENOENT) return fail_with_errno(path, "cannot open the log", error);
  close_file();
  fd_ = opened;
  const bool is_sound = fd_ >= 0 && understand(capacity);
  if (fd_ >= 0 && !is_sound) set_aside(path);
  const bool takes_records = is_sound && record_bytes_ == kRecordBytes;
  if (takes_records) repair();
  if (takes_records && capacity_ == capacity) return true;
  const std::int64_t capacity_before = std::exchange(capacity_, capacity);
  if (replace(path, error)) return true;
  if (takes_records && is_disk_trouble(errno)) {
    capacity_ = capacity_before;
    return true;
  }
  const int cause = errno;
  close_file();
  errno = cause;
  return false;
}

/// On a read-only disk the log can be read but not extended. Always false.
bool RingLog::open_read_only(const char* path, std::int64_t capacity, FileMessage& error) {
  if (fd_ < 0) {  // else already read, and unchanged
    fd_ = ::open(path, O_RDONLY | O_CLOEXEC);
    damage_.is_set_aside = fd_ >= 0 && !understand(capacity);
    damage_.is_read_only = damage_.is_set_aside;
    if (damage_.is_set_aside) close_file();
    is_read_only_ = fd_ >= 0;
  }
  errno = EROFS;
  return fail_with_errno(path, "cannot open the log", error);
}

bool RingLog::open_to_read(const char* path, FileMessage& error) {
  fd_ = ::open(path, O_RDONLY | O_CLOEXEC);
  if (fd_ < 0) return fail_with_errno(path, "cannot open the log", error);
  const bool has_header = read_header(0) || read_header(kHeaderCopyAt);
  if ((has_header && find_newest_by_number()) || understand(0)) return true;
  close_file();
  char line[700];
  std::snprintf(line, sizeof line,
                "%s: is not a decision log of this program; the next start renames it to .old",
                path);
  static_cast<void>(error.assign(line));
  return false;
}

/// Renames an unreadable log, only for manual inspection.
void RingLog::set_aside(const char* path) {
  damage_.is_set_aside = true;
  const FixedText<643> aside = path_with(path, ".old");
  if (rename(path, aside.c_str()) == 0) close_file();
}

/// The new file is complete before the old one is renamed.
bool RingLog::replace(const char* path, FileMessage& error) {
  const FixedText<643> new_path = path_with(path, ".new");
  const int made = make_whole(new_path.c_str());
  if (made < 0) return fail_with_errno(new_path.c_str(), "cannot create the log", error);
  const bool is_free = fd_ < 0 || rename(path, path_with(path, ".old").c_str()) == 0;
  if (!is_free || rename(new_path.c_str(), path) != 0) {
    fail_with_errno(path, "cannot rename the log", error);
    close(made);
    unlink(new_path.c_str());
    return false;
  }
  close_file();
  fd_ = made;
  record_bytes_ = kRecordBytes;
  sync_folder_of(path);
  return true;
}

/// Creates a file of full size with header and newest known record, synced to disk. Negative with
/// errno set, and no file left.
int RingLog::make_whole(const char* path) const {
  const int made = make_afresh(path);
  if (made < 0) return -1;
  const std::int64_t size = kHeaderBytes + capacity_ * static_cast<std::int64_t>(kRecordBytes);
  int cause = posix_fallocate(made, 0, size);  // detects a full disk now, not in a month
  errno = ENOSPC;                              // what a short write means
  if (cause == 0 && write_header(made) && write_newest(made) && fsync(made) == 0) return made;
  if (cause == 0) cause = errno;
  close(made);
  unlink(path);
  errno = cause;
  return -1;
}

/// By header, its copy, or the records. `likely_capacity` 0: unknown.
bool RingLog::understand(std::int64_t likely_capacity) {
  if (read_header(0) || read_header(kHeaderCopyAt)) {
    const Scan scan = find_newest();
    damage_.broken_records = scan.broken;
    damage_.missing_records = scan.missing;
  } else if (find_geometry(likely_capacity)) {
    damage_.header = RingDamage::Header::kFromRecords;
  } else {
    return false;
  }
  damage_.newest_lost = 0;
  while (damage_.newest_lost < damage_.broken_records + damage_.missing_records &&
         is_lost_at(newest_number_ + 1 + static_cast<std::uint64_t>(damage_.newest_lost))) {
    ++damage_.newest_lost;
  }
  return true;
}

bool RingLog::read_header(std::int64_t offset) {
  std::uint8_t header[kHeaderUsedBytes];
  if (pread(fd_, header, sizeof header, offset) != static_cast<ssize_t>(sizeof header)) {
    return false;
  }
  const auto capacity = static_cast<std::int64_t>(take_bytes(8, header + 16));
  record_bytes_ =
      take_bytes(4, header + 12) == kOlderRecordBytes ? kOlderRecordBytes : kRecordBytes;
  std::uint8_t expected[kHeaderUsedBytes];
  fill_header(expected, record_bytes_, capacity);
  const std::int64_t most = (INT64_MAX - kHeaderBytes) / static_cast<std::int64_t>(kRecordBytes);
  if (std::memcmp(header, expected, sizeof header) != 0 || capacity < 1 || capacity > most) {
    return false;
  }
  struct stat info {};
  capacity_ = capacity;
  if (offset != 0) damage_.header = RingDamage::Header::kFromCopy;
  return fstat(fd_, &info) == 0;
}

/// Without a header: the file size gives the number of records, and each record's number its slot.
bool RingLog::find_geometry(std::int64_t likely_capacity) {
  struct stat info {};
  if (fstat(fd_, &info) != 0 || info.st_size <= kHeaderBytes) return false;
  const auto by_size = [&](std::size_t record_bytes) {
    return Geometry{record_bytes,
                    (info.st_size - kHeaderBytes) / static_cast<std::int64_t>(record_bytes)};
  };
  if (fits({kRecordBytes, likely_capacity}) || fits(by_size(kRecordBytes)) ||
      fits(by_size(kOlderRecordBytes))) {
    return true;
  }
  newest_number_ = 0;
  damage_.broken_records = damage_.missing_records = 0;
  return false;
}

/// True also for an empty log of the expected size.
bool RingLog::fits(const Geometry& geometry) {
  if (geometry.capacity < 1) return false;
  record_bytes_ = geometry.record_bytes;
  capacity_ = geometry.capacity;
  newest_number_ = 0;
  const Scan scan = find_newest();
  damage_.broken_records = scan.broken;
  damage_.missing_records = scan.missing;
  const bool is_empty = scan.whole == 0 && scan.broken == 0 && scan.missing == 0;
  return scan.misplaced == 0 && (scan.whole > 0 || is_empty);
}

/// Restores headers and file size. On a disk error the next start tries again.
void RingLog::repair() {
  const bool is_written = write_header(fd_);
  const bool is_long = damage_.missing_records == 0 || posix_fallocate(fd_, 0, file_bytes()) == 0;
  const bool is_kept = damage_.is_any() && is_written && is_long && fdatasync(fd_) == 0;
  static_cast<void>(is_kept);
}

/// Writes the newest record into a new file of `capacity_`.
bool RingLog::write_newest(int fd) const {
  if (newest_number_ == 0) return true;
  RecordBytes bytes;
  encode_record(newest_, newest_number_, bytes);
  const auto slot =
      static_cast<std::int64_t>(newest_number_ % static_cast<std::uint64_t>(capacity_));
  const std::int64_t offset = kHeaderBytes + slot * static_cast<std::int64_t>(kRecordBytes);
  return pwrite(fd, bytes.data(), bytes.size(), offset) == static_cast<ssize_t>(bytes.size());
}

bool RingLog::write_header(int fd) const {
  std::uint8_t header[kHeaderUsedBytes];
  std::uint8_t there[kHeaderUsedBytes];
  fill_header(header, kRecordBytes, capacity_);
  for (const std::int64_t offset : {std::int64_t{0}, kHeaderCopyAt}) {
    constexpr auto kSize = static_cast<ssize_t>(sizeof header);
    const bool is_there = pread(fd, there, sizeof there, offset) == kSize &&
                          std::memcmp(there, header, sizeof header) == 0;
    if (!is_there && pwrite(fd, header, sizeof header, offset) != kSize) return false;
  }
  return true;
}

/// Fast search by the numbers at the heads of the records. False if the newest is not intact, on a
/// read error, and for an empty log: then each record is checked.
bool RingLog::find_newest_by_number() {
  constexpr std::int64_t kSlotsOfChunk = 64;
  std::uint8_t chunk[static_cast<std::size_t>(kSlotsOfChunk) * kRecordBytes];
  const auto record_bytes = static_cast<std::int64_t>(record_bytes_);
  std::uint64_t newest = 0;
  for (std::int64_t slot = 0; slot < capacity_;) {
    const std::int64_t count = std::min(kSlotsOfChunk, capacity_ - slot);
    const ssize_t bytes = pread(fd_, chunk, static_cast<std::size_t>(count * record_bytes),
                                kHeaderBytes + slot * record_bytes);
    if (bytes != count * record_bytes) return false;
    for (std::int64_t i = 0; i < count; ++i, ++slot) {
      const std::uint64_t number = take_bytes(8, chunk + i * record_bytes);
      const bool is_in_place =
          number % static_cast<std::uint64_t>(capacity_) == static_cast<std::uint64_t>(slot);
      if (is_in_place && number > newest) newest = number;
    }
  }
  if (newest == 0 || !read(newest, newest_)) return false;
  newest_number_ = newest;
  return true;
}

/// A read error loses only the records of that place.
RingLog::Scan RingLog::find_newest() {
  constexpr std::int64_t kSlotsOfChunk = 64;
  std::uint8_t chunk[static_cast<std::size_t>(kSlotsOfChunk) * kRecordBytes];
  const auto record_bytes = static_cast<std::int64_t>(record_bytes_);
  Scan scan;
  std::int64_t slots_at_once = kSlotsOfChunk;
  for (std::int64_t slot = 0; slot < capacity_;) {
    const std::int64_t left = capacity_ - slot;
    const std::int64_t wanted = slots_at_once < left ? slots_at_once : left;
    const ssize_t bytes = pread(fd_, chunk, static_cast<std::size_t>(wanted * record_bytes),
                                kHeaderBytes + slot * record_bytes);
    const std::int64_t count = bytes / record_bytes;
    if (bytes >= 0 && count == 0) {
      scan.missing = left;
      return scan;
    }
    if (bytes < 0 && slots_at_once > 1) {  // from here one by one
      slots_at_once = 1;
      continue;
    }
    if (bytes < 0) {
      ++scan.broken;
      ++slot;
      continue;
    }
    for (std::int64_t i = 0; i < count; ++i, ++slot) {
      look_at({chunk + i * record_bytes, record_bytes_}, slot, scan);
    }
  }
  return scan;
}

void RingLog::look_at(std::span<const std::uint8_t> stored, std::int64_t slot, Scan& scan) {
  CycleRecord record;
  std::uint64_t number = 0;
  if (!decode_record(stored, record, number)) {
    scan.broken += is_broken(stored) ? 1 : 0;
  } else if (number % static_cast<std::uint64_t>(capacity_) != static_cast<std::uint64_t>(slot)) {
    ++scan.misplaced;
  } else {
    ++scan.whole;
    if (number <= newest_number_) return;
    newest_number_ = number;
    newest_ = record;
  }
}

/// Whether the slot of this record is unreadable or broken.
bool RingLog::is_lost_at(std::uint64_t number) const {
  RecordBytes bytes;
  const ssize_t got = pread(fd_, bytes.data(), record_bytes_, offset_of(number));
  const auto stored = std::span<const std::uint8_t>(bytes).first(record_bytes_);
  return got != static_cast<ssize_t>(record_bytes_) || is_broken(stored);
}

bool RingLog::is_at(const char* path) const {
  struct stat ours {};
  struct stat there {};
  if (stat(path, &there) != 0) return errno != ENOENT;  // a disk that does not answer has not moved
  return fstat(fd_, &ours) == 0 && ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
}

bool RingLog::append(const CycleRecord& record, std::uint64_t number) {
  RecordBytes bytes;
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
  if (fd_ < 0) return false;
  RecordBytes bytes;
  const ssize_t got = pread(fd_, bytes.data(), record_bytes_, offset_of(number));
  std::uint64_t found = 0;
  return got == static_cast<ssize_t>(record_bytes_) &&
         decode_record(std::span(bytes).first(record_bytes_), record, found) && found == number;
}

}  // namespace bess
