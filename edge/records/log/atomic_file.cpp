#include "edge/records/log/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "shared/crc32.h"
#include "shared/file_descriptor.h"

namespace bess {

namespace {

constexpr std::size_t kDigits = 8;

/// End of the text with the size of this frame's checksum; a shorter text in full.
std::string_view end_of(std::string_view text, const ChecksumFrame& frame) {
  const std::size_t size = frame.before.size() + kDigits + frame.after.size();
  return text.size() < size ? text : text.substr(text.size() - size);
}

}  // namespace

FixedText<31> checksum_end(std::string_view text, const ChecksumFrame& frame) {
  char end[32];
  std::snprintf(end, sizeof end, "%.*s%08x%.*s", static_cast<int>(frame.before.size()),
                frame.before.data(), crc32_of(text.data(), text.size()),
                static_cast<int>(frame.after.size()), frame.after.data());
  return {end};
}

ChecksumState check_text(std::string_view text, const ChecksumFrame& frame) {
  const std::string_view end = end_of(text, frame);
  if (!end.starts_with(frame.before) || !end.ends_with(frame.after))
    return ChecksumState::kUnchecked;
  const std::string_view body = text.substr(0, text.size() - end.size());
  return checksum_end(body, frame).view() == end ? ChecksumState::kIntact : ChecksumState::kBroken;
}

std::string_view without_checksum(std::string_view text, const ChecksumFrame& frame) {
  if (check_text(text, frame) == ChecksumState::kUnchecked) return text;
  return text.substr(0, text.size() - end_of(text, frame).size());
}

namespace {

/// File permissions follow the folder's permissions, independent of umask and creator: the service
/// must be able to read and replace files made by root.
void set_ownership(int fd, uid_t user, gid_t group, mode_t mode) {
  struct stat made {};
  if (fstat(fd, &made) != 0) return;
  const bool is_root = geteuid() == 0;
  const bool is_others = made.st_uid != user || made.st_gid != group;
  // On refusal the file keeps its owner.
  bool is_done = !is_root || !is_others || fchown(fd, user, group) == 0;
  if ((made.st_mode & 07777) != mode) is_done = fchmod(fd, mode) == 0 && is_done;
  static_cast<void>(is_done);
}

void belong_to_folder(int fd, const char* path) {
  constexpr mode_t kReaders = S_IRGRP | S_IROTH;
  struct stat folder {};
  if (stat(folder_of(path).c_str(), &folder) != 0) return;
  set_ownership(fd, folder.st_uid, folder.st_gid, S_IRUSR | S_IWUSR | (folder.st_mode & kReaders));
}

bool replace(const char* path, std::string_view text, bool is_synced) {
  char new_path[640];
  const int length = std::snprintf(new_path, sizeof new_path, "%s.new", path);
  if (length < 0 || length >= static_cast<int>(sizeof new_path)) {
    errno = ENAMETOOLONG;
    return false;
  }
  const int fd = make_afresh(new_path);
  if (fd < 0) return false;
  const bool written = append_whole(fd, text) && (!is_synced || fsync(fd) == 0);
  const int write_errno = errno;
  close(fd);
  if (written && rename(new_path, path) == 0) return true;
  const int cause = written ? errno : write_errno;
  unlink(new_path);
  errno = cause;
  return false;
}

}  // namespace

bool append_whole(int fd, std::string_view text) {
  errno = ENOSPC;  // what a short write means
  const ssize_t done = write(fd, text.data(), text.size());
  if (done == static_cast<ssize_t>(text.size())) return true;
  const int cause = errno;
  struct stat info {};
  if (done > 0 && fstat(fd, &info) == 0) static_cast<void>(!ftruncate(fd, info.st_size - done));
  errno = cause;
  return false;
}

bool has_trusted_owner(uid_t owner, const char* path) {
  if (owner == 0 || owner == geteuid()) return true;
  struct stat folder {};
  return stat(folder_of(path).c_str(), &folder) == 0 && folder.st_uid == owner;
}

ssize_t read_beginning(const char* path, std::span<char> text, SymlinkPolicy symlinks) {
  const int follow = symlinks == SymlinkPolicy::kRefused ? O_NOFOLLOW : 0;
  const FileDescriptor file(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | follow));
  struct stat facts {};
  if (file.get() < 0 || fstat(file.get(), &facts) != 0) return -1;
  if (!S_ISREG(facts.st_mode)) {
    errno = S_ISDIR(facts.st_mode) ? EISDIR : EINVAL;
    return -1;
  }
  if (symlinks == SymlinkPolicy::kRefused && !has_trusted_owner(facts.st_uid, path)) {
    errno = EPERM;
    return -1;
  }
  return pread(file.get(), text.data(), text.size(), 0);
}

int make_afresh(const char* path) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  int fd = open(path, kFlags, 0644);
  if (fd < 0 && errno == EEXIST && unlink(path) == 0) fd = open(path, kFlags, 0644);
  if (fd >= 0) belong_to_folder(fd, path);
  return fd;
}

bool make_folder(const char* path) {
  constexpr mode_t kMode = 0755;
  if (mkdir(path, kMode) != 0) return errno == EEXIST;
  const FileDescriptor made(open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  struct stat parent {};
  if (made.get() >= 0 && stat(folder_of(path).c_str(), &parent) == 0) {
    set_ownership(made.get(), parent.st_uid, parent.st_gid, kMode);
  }
  return true;
}

FixedText<639> folder_of(const char* path) {
  const FixedText<639> text(path);
  const std::size_t slash = text.view().rfind('/');
  if (slash == std::string_view::npos) return {"."};
  return {text.view().substr(0, slash == 0 ? 1 : slash)};
}

bool is_disk_trouble(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG || error == EROFS || error == EIO;
}

bool replace_file(const char* path, std::string_view text) { return replace(path, text, false); }

bool replace_or_remove_file(const char* path, std::string_view text) {
  if (replace_file(path, text)) return true;
  const int cause = errno;
  if (is_disk_trouble(cause) && unlink(path) == 0) return replace_file(path, text);
  errno = cause;
  return false;
}

bool replace_file_durably(const char* path, std::string_view text) {
  if (!replace(path, text, true)) return false;
  sync_folder_of(path);
  return true;
}

void sync_folder_of(const char* path) {
  const FileDescriptor folder(open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0) fsync(folder.get());
}

bool fail_with_errno(const char* path, std::string_view what, FileMessage& error) {
  const int cause = errno;
  const bool is_refused = cause == EACCES || cause == EPERM;
  char reason_buffer[128];
  const char* reason = strerror_r(cause, reason_buffer, sizeof reason_buffer);
  char line[768];
  std::snprintf(line, sizeof line, "%s: %.*s: %s%s", path, static_cast<int>(what.size()),
                what.data(), reason,
                is_refused ? " (check that it belongs to the user that runs bess-edge)" : "");
  static_cast<void>(error.assign(line));
  errno = cause;
  return false;
}

}  // namespace bess
