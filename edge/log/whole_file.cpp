#include "edge/log/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "shared/file_descriptor.h"

namespace bess {
namespace {

enum class Durability { kOrdinary, kOnDisk };

bool replace(const char* path, std::string_view text, Durability durability) {
  char beside[640];
  const int length = std::snprintf(beside, sizeof beside, "%s.new", path);
  if (length < 0 || length >= static_cast<int>(sizeof beside)) {
    errno = ENAMETOOLONG;
    return false;
  }
  const int fd = make_afresh(beside);
  if (fd < 0) return false;
  errno = ENOSPC;  // what a short write means
  const bool written = write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       (durability == Durability::kOrdinary || fsync(fd) == 0);
  const int write_errno = errno;
  close(fd);
  if (written && rename(beside, path) == 0) return true;
  const int cause = written ? errno : write_errno;
  unlink(beside);
  errno = cause;
  return false;
}

}  // namespace

ssize_t read_beginning(const char* path, std::span<char> text, Links links) {
  const int follow = links == Links::kRefused ? O_NOFOLLOW : 0;
  const FileDescriptor file(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | follow));
  struct stat facts {};
  if (file.get() < 0 || fstat(file.get(), &facts) != 0) return -1;
  if (S_ISREG(facts.st_mode)) return pread(file.get(), text.data(), text.size(), 0);
  errno = EINVAL;
  return -1;
}

int make_afresh(const char* path) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  const int fd = open(path, kFlags, 0644);
  if (fd >= 0 || errno != EEXIST) return fd;
  return unlink(path) == 0 ? open(path, kFlags, 0644) : -1;
}

bool is_disk_trouble(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG || error == EROFS || error == EIO;
}

bool replace_file(const char* path, std::string_view text) {
  return replace(path, text, Durability::kOrdinary);
}

bool replace_or_remove_file(const char* path, std::string_view text) {
  if (replace_file(path, text)) return true;
  const int cause = errno;
  if (is_disk_trouble(cause) && unlink(path) == 0) return replace_file(path, text);
  errno = cause;
  return false;
}

bool replace_file_durably(const char* path, std::string_view text) {
  if (!replace(path, text, Durability::kOnDisk)) return false;
  sync_folder_of(path);
  return true;
}

void sync_folder_of(const char* path) {
  FixedText<639> folder(path);
  const std::size_t slash = folder.view().rfind('/');
  if (slash == std::string_view::npos) {
    folder = ".";
  } else {
    folder = FixedText<639>(std::string_view(path, slash == 0 ? 1 : slash));
  }
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  fsync(fd);
  close(fd);
}

bool fail_with_errno(const char* path, std::string_view what, FileMessage& error) {
  const int cause = errno;
  const bool is_refused = cause == EACCES || cause == EPERM;
  char reason_buffer[128];
  const char* reason = strerror_r(cause, reason_buffer, sizeof reason_buffer);
  char line[768];
  std::snprintf(line, sizeof line, "%s: %.*s: %s%s", path, static_cast<int>(what.size()),
                what.data(), reason,
                is_refused ? " (does it belong to the user that runs bess-edge?)" : "");
  static_cast<void>(error.assign(line));
  errno = cause;
  return false;
}

}  // namespace bess
