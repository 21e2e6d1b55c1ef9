// Failing disk under a running program, for LD_PRELOAD: while the file that BESS_DYING_DISK names
// holds "EROFS FOLDER" or "EIO FOLDER", calls on files in FOLDER fail as on a card that the kernel
// has remounted read-only, or that no longer answers. A real remount is refused while a log is open
// for writing; the kernel's own remount after an error is tested where a test may mount
// (dying_disk_test). Direct system calls: nothing here allocates or loads other libraries.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

enum class Fault { kNone, kReadOnly, kBroken };

/// A successful call leaves errno unchanged, here too.
class SavedErrno {
 public:
  SavedErrno() = default;
  SavedErrno(const SavedErrno&) = delete;
  SavedErrno& operator=(const SavedErrno&) = delete;
  ~SavedErrno() { errno = kept_; }

 private:
  int kept_ = errno;
};

/// Fault of the disk that holds `path`, which is absolute.
Fault fault_at(const char* path) {
  const SavedErrno kept;
  const char* const control = std::getenv("BESS_DYING_DISK");
  if (control == nullptr) return Fault::kNone;
  char text[512] = {};
  const int fd = static_cast<int>(syscall(SYS_openat, AT_FDCWD, control, O_RDONLY | O_CLOEXEC));
  if (fd < 0) return Fault::kNone;
  const long size = syscall(SYS_read, fd, text, sizeof text - 1);
  syscall(SYS_close, fd);
  const char* const folder = size > 0 ? std::strchr(text, ' ') : nullptr;
  if (folder == nullptr) return Fault::kNone;
  const std::size_t length = std::strlen(folder + 1);
  const bool is_there =
      std::strncmp(path, folder + 1, length) == 0 && (path[length] == '/' || path[length] == '\0');
  if (!is_there) return Fault::kNone;
  return text[1] == 'R' ? Fault::kReadOnly : Fault::kBroken;
}

Fault fault_of(int fd) {
  const SavedErrno kept;
  char name[64];
  char path[512] = {};
  std::snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
  const long size = syscall(SYS_readlinkat, AT_FDCWD, name, path, sizeof path - 1);
  return size > 0 ? fault_at(path) : Fault::kNone;
}

int errno_of(Fault fault) { return fault == Fault::kReadOnly ? EROFS : EIO; }

/// Fails as the disk does, or makes the call.
template <typename... Arguments>
long unless(Fault fault, long number, Arguments... arguments) {
  if (fault == Fault::kNone) return syscall(number, arguments...);
  errno = errno_of(fault);
  return -1;
}

bool exists(const char* path) {
  const SavedErrno kept;
  return syscall(SYS_faccessat, AT_FDCWD, path, F_OK) == 0;
}

int open_or_fail(const char* path, int flags, mode_t mode) {
  Fault fault = fault_at(path);
  const bool writes = (flags & O_ACCMODE) != O_RDONLY || ((flags & O_CREAT) != 0 && !exists(path));
  if (fault == Fault::kReadOnly && ((flags & O_CREAT) == 0 && !exists(path))) fault = Fault::kNone;
  if (fault == Fault::kReadOnly && !writes) fault = Fault::kNone;
  return static_cast<int>(unless(fault, SYS_openat, AT_FDCWD, path, flags, mode));
}

mode_t mode_in(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

Fault when_broken(Fault fault) { return fault == Fault::kBroken ? fault : Fault::kNone; }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_in(flags, arguments);
  va_end(arguments);
  return open_or_fail(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_in(flags, arguments);
  va_end(arguments);
  return open_or_fail(path, flags, mode);
}
/// Streams for reading. Nothing under test writes through one.
FILE* fopen(const char* path, const char* mode) {
  const bool writes = *mode != 'r';
  const int flags = *mode == 'r'   ? O_RDONLY
                    : *mode == 'a' ? O_WRONLY | O_CREAT | O_APPEND
                                   : O_WRONLY | O_CREAT | O_TRUNC;
  const bool reads_too = std::strchr(mode, '+') != nullptr;
  const int fd =
      open_or_fail(path, reads_too ? (flags & ~O_ACCMODE) | O_RDWR : flags, writes ? 0666 : 0);
  return fd < 0 ? nullptr : fdopen(fd, mode);
}
FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }
ssize_t pread(int fd, void* bytes, size_t size, off_t offset) {
  return unless(when_broken(fault_of(fd)), SYS_pread64, fd, bytes, size, offset);
}
ssize_t pread64(int fd, void* bytes, size_t size, off64_t offset) {
  return pread(fd, bytes, size, offset);
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
  return unless(fault_of(fd), SYS_pwrite64, fd, bytes, size, offset);
}
ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t offset) {
  return pwrite(fd, bytes, size, offset);
}
ssize_t write(int fd, const void* bytes, size_t size) {
  return unless(fault_of(fd), SYS_write, fd, bytes, size);
}
int fsync(int fd) { return static_cast<int>(unless(fault_of(fd), SYS_fsync, fd)); }
int fdatasync(int fd) { return static_cast<int>(unless(fault_of(fd), SYS_fdatasync, fd)); }
int rename(const char* from, const char* to) {
  return static_cast<int>(unless(fault_at(to), SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int unlink(const char* path) {
  return static_cast<int>(unless(fault_at(path), SYS_unlinkat, AT_FDCWD, path, 0));
}
int mkdir(const char* path, mode_t mode) {
  return static_cast<int>(
      unless(exists(path) ? Fault::kNone : fault_at(path), SYS_mkdirat, AT_FDCWD, path, mode));
}
int statvfs(const char* path, struct statvfs* out) {
  struct statfs disk {};
  const Fault fault = fault_at(path);
  if (unless(when_broken(fault), SYS_statfs, path, &disk) != 0) return -1;
  *out = {};
  out->f_frsize = out->f_bsize = static_cast<unsigned long>(disk.f_bsize);
  out->f_blocks = disk.f_blocks;
  out->f_bfree = disk.f_bfree;
  out->f_bavail = disk.f_bavail;
  out->f_flag = (static_cast<unsigned long>(disk.f_flags) & ST_RDONLY) |
                (fault == Fault::kReadOnly ? ST_RDONLY : 0UL);
  return 0;
}
int statvfs64(const char* path, struct statvfs64* out) {
  return statvfs(path, reinterpret_cast<struct statvfs*>(out));
}
}
