#include "edge/program/instance_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>

#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// First without O_CREAT: in a sticky folder such as /run/lock the kernel (fs.protected_regular)
/// refuses O_CREAT on another user's file, even to root.
int open_or_create(const char* path) {
  constexpr int kFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;
  const int fd = open(path, kFlags);
  if (fd >= 0 || errno != ENOENT) return fd;
  const int made = open(path, kFlags | O_CREAT | O_EXCL, 0666);
  if (made < 0) return errno == EEXIST ? open(path, kFlags) : -1;
  fchmod(made, 0666);  // another user's controller must be able to meet this lock, whatever umask
  return made;
}

/// The holder removes its file when it ends; a lock on a removed file would lock nothing.
bool is_still_at(int fd, const char* path) {
  struct stat ours {};
  struct stat there {};
  return fstat(fd, &ours) == 0 && stat(path, &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

int pid_in(int fd) {
  char text[16] = {};
  if (pread(fd, text, sizeof text - 1, 0) <= 0) return -1;
  const long pid = std::strtol(text, nullptr, 10);  // 0 when it is no number
  return pid > 0 && pid <= INT_MAX ? static_cast<int>(pid) : -1;
}

}  // namespace

InstanceLock::~InstanceLock() {
  if (fd_ < 0) return;
  unlink(path_.c_str());  // while still holding it; see is_still_at
  close(fd_);
}

bool InstanceLock::take(const char* path, const char* what, FileMessage& error) {
  constexpr int kTries = 11;
  constexpr std::int64_t kPauseNs = kNanosecondsPerSecond / 10;
  bool is_held = false;
  for (int i = 0; i < kTries; ++i) {
    if (try_once(path, is_held)) {
      path_ = FixedText<639>(path);
      leave_pid();
      return true;
    }
    if (!is_held) return fail_with_errno(path, "cannot make the lock", error);
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kPauseNs);
  }
  char line[768];
  std::snprintf(
      line, sizeof line,
      "%s is in use by another bess-edge (process %d, lock %s): two must not share it, not "
      "even to read; stop that one, or ask bess-edge status",
      what, holder_of(path), path);
  static_cast<void>(error.assign(line));
  return false;
}

bool InstanceLock::try_once(const char* path, bool& is_held) {
  is_held = false;
  const int fd = open_or_create(path);
  if (fd < 0) return false;
  if (flock(fd, LOCK_EX | LOCK_NB) == 0 && is_still_at(fd, path)) {
    fd_ = fd;
    return true;
  }
  is_held = true;  // or its file was just removed: the next try makes a new one
  close(fd);
  return false;
}

void InstanceLock::leave_pid() const {
  char text[16];
  const int length = std::snprintf(text, sizeof text, "%d\n", static_cast<int>(getpid()));
  const bool written = ftruncate(fd_, 0) == 0 && pwrite(fd_, text, length, 0) == length;
  static_cast<void>(written);  // only for the message of the next one who comes
}

int holder_of(const char* path) {
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return 0;
  int holder = 0;
  if (flock(fd, LOCK_SH | LOCK_NB) != 0) holder = pid_in(fd);
  close(fd);
  return holder;
}

}  // namespace bess
