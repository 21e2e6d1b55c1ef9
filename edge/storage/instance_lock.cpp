#include "edge/storage/instance_lock.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>

#include "edge/log/journal.h"
#include "edge/storage/file_owner.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// For its owner alone: whoever may open a file, if only to read it, can hold its lock.
constexpr mode_t kLockMode = 0600;

/// First without O_CREAT: in a sticky folder such as /run/lock the kernel (fs.protected_regular)
/// refuses O_CREAT on another user's file, even to root.
int open_or_create(const char* path) {
  constexpr int kFlags = O_CLOEXEC | O_NOFOLLOW;
  int fd = open(path, O_RDWR | kFlags);
  if (fd < 0 && errno == EROFS) fd = open(path, O_RDONLY | kFlags);  // a lock needs no writing
  if (fd >= 0 || errno != ENOENT) return fd;
  const int made = open(path, O_RDWR | O_CREAT | O_EXCL | kFlags, kLockMode);
  return made < 0 && errno == EEXIST ? open(path, O_RDWR | kFlags) : made;
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
  for (int i = 0; i < kTries; ++i) {
    const Try result = try_once(path);
    if (result == Try::kTaken) {
      path_ = FixedText<639>(path);
      leave_pid();
      return true;
    }
    if (result == Try::kFailed) return explain(path, error);
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kPauseNs);
  }
  FileMessage stranger;
  const bool is_strangers = !refuse_stranger(path, stranger);
  char line[1'700];  // of two messages; what is too long for one is cut
  std::snprintf(line, sizeof line,
                "%s is in use by another program (process %d, lock %s): two must not share it, not "
                "even to read; stop that one, or ask bess-edge status%s%s",
                what, holder_of(path), path, is_strangers ? "; " : "", stranger.c_str());
  static_cast<void>(error.assign(line));
  return false;
}

InstanceLock::Try InstanceLock::try_once(const char* path) {
  const int fd = open_or_create(path);
  if (fd < 0) return Try::kFailed;
  if (flock(fd, LOCK_EX | LOCK_NB) != 0 || !is_still_at(fd, path)) {
    close(fd);
    return Try::kHeld;  // or its file was just removed: the next try makes a new one
  }
  struct stat info {};
  if (fstat(fd, &info) == 0 && is_trusted(info.st_uid)) {
    fd_ = fd;
    return Try::kTaken;
  }
  close(fd);
  errno = EACCES;  // its owner could take it from us, or remove it, at any time
  return Try::kFailed;
}

/// True where only the disk stands in the way: the battery is driven all the same.
bool InstanceLock::explain(const char* path, FileMessage& error) {
  const int cause = errno;
  static_cast<void>(fail_with_errno(path, "cannot make the lock", error));
  if (is_disk_trouble(cause)) {
    report(JournalLevel::kWarning, "note: %s: going on without it", error.c_str());
    error = {};
    return true;
  }
  if (cause == EACCES && refuse_stranger(path, error)) {
    static_cast<void>(refuse_roots_leftover(path, error));
  }
  return false;
}

void InstanceLock::leave_pid() const {
  fchmod(fd_, kLockMode);  // of an older program, which let everybody write
  char text[16];
  const int length = std::snprintf(text, sizeof text, "%d\n", static_cast<int>(getpid()));
  const bool written = ftruncate(fd_, 0) == 0 && pwrite(fd_, text, length, 0) == length;
  static_cast<void>(written);  // only for the message of the next one who comes
}

int holder_of(const char* path) {
  if (!is_believable(path)) return 0;
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return errno == EACCES ? kHolderHidden : 0;
  int holder = 0;
  if (flock(fd, LOCK_SH | LOCK_NB) != 0) holder = pid_in(fd);
  // On a read-only disk a lock keeps the number of whoever could write it last.
  if (holder > 0 && kill(holder, 0) != 0 && errno == ESRCH) holder = -1;
  close(fd);
  return holder;
}

}  // namespace bess
