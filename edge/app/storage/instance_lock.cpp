#include "edge/app/storage/instance_lock.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>

#include "edge/records/log/journal.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"

namespace bess {

namespace {

/// True for root and the user of this process.
bool is_trusted(uid_t owner) { return owner == 0 || owner == geteuid(); }

/// For a file that this process relies on or replaces: false with one line if it exists and belongs
/// to another user. Checks a link itself.
bool check_file_owner(const char* path, FileMessage& error) {
  struct stat info {};
  if (lstat(path, &info) != 0 || is_trusted(info.st_uid)) return true;
  error = foreign_file_error(path);
  return false;
}

/// For a file of root that this process may not open: false with one line and the command that
/// removes it.
bool check_root_leftover(const char* path, FileMessage& error) {
  struct stat info {};
  if (geteuid() == 0 || lstat(path, &info) != 0 || info.st_uid != 0) return true;
  error = FileMessage(
      formatted("%s belongs to a bess-edge started as root: if it no longer runs (pgrep -u root -x "
                "bess-edge), remove its lock: sudo rm %s",
                path, path));
  return false;
}

/// Lock name of the battery. Serial devices by real path, because /dev/serial/by-id/... and
/// /dev/ttyUSB0 may be one device; without the unit, because a line has one master.
FixedText<159> lock_subject(const EdgeConfig& config) {
  if (!config.battery.link.rtu) return battery_place(config.battery);
  char real[PATH_MAX];
  const char* const found = realpath(config.battery.link.device.c_str(), real);
  return {found != nullptr ? found : config.battery.link.device.c_str()};
}

bool lock_run_folder(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  const char* const folder = config.state.run_folder.c_str();
  if (*folder == '\0') return true;
  if (!make_folder(folder)) {
    static_cast<void>(
        fail_with_errno(folder, "cannot create the folder of [state] run_folder", error));
    report(JournalLevel::kWarning, "note: %s: continuing without it", error.c_str());
    error = {};
    return true;
  }
  return locks.run.take(run_file(config, "lock").c_str(), std::string("the run folder ") + folder,
                        error);
}

}  // namespace

FileMessage foreign_file_error(const char* path) {
  struct stat info {};
  const bool is_known = lstat(path, &info) == 0;
  return FileMessage(formatted(
      "%.500s belongs to user %ld, not to root or the user of this bess-edge (%ld): remove "
      "it, unless that user runs a bess-edge",
      path, is_known ? static_cast<long>(info.st_uid) : -1L, static_cast<long>(geteuid())));
}

bool is_believable(const char* path) {
  struct stat file {};
  return lstat(path, &file) != 0 || has_trusted_owner(file.st_uid, path);
}

FixedText<639> battery_lock_path(const EdgeConfig& config) {
  std::string name(lock_subject(config).view());
  for (char& c : name) c = c == '/' || c == ' ' || c == ':' ? '_' : c;
  return formatted("%s/bess-%s.lock", lock_folder(), name.c_str()).c_str();
}

FixedText<639> name_lock_path(const EdgeConfig& config) {
  return formatted("%s/bess-name-%s.lock", lock_folder(), config.battery.name.c_str()).c_str();
}

const char* lock_folder() {
  struct stat info {};
  const bool is_there = stat("/run/lock", &info) == 0 && S_ISDIR(info.st_mode);
  return is_there ? "/run/lock" : "/tmp";
}

int controller_holding(const EdgeConfig& config) {
  const bool has_run_folder = !config.state.run_folder.empty();
  const int of_run_folder = has_run_folder ? lock_owner_pid(run_file(config, "lock").c_str()) : 0;
  if (of_run_folder > 0) return of_run_folder;
  const int of_state_folder = lock_owner_pid(state_file(config, "lock").c_str());
  return of_state_folder != 0 ? of_state_folder : of_run_folder;
}

bool is_controller_running(const EdgeConfig& config) { return controller_holding(config) != 0; }

bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  return locks.battery.take(battery_lock_path(config).c_str(),
                            formatted("the battery at %s", battery_place(config.battery).c_str()),
                            error);
}

bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  const char* const folder = config.state.folder.c_str();
  if (!make_folder(folder)) {
    return fail_with_errno(folder, "cannot create the folder of [state] folder", error);
  }
  for (const auto& path : {stored_status_path(config.log.status), config.log.ring,
                           stored_status_path(config.log.run_status), config.log.run_ring}) {
    if (!check_file_owner(path.c_str(), error)) return false;
  }
  return locks.state.take(state_file(config, "lock").c_str(),
                          std::string("the state folder ") + folder, error) &&
         locks.name.take(name_lock_path(config).c_str(),
                         formatted("[battery] name %s", config.battery.name.c_str()), error) &&
         lock_run_folder(config, locks, error);
}

namespace {

/// Owner-only permissions, because a reader could also hold the lock.
constexpr mode_t kLockMode = 0600;

/// First without O_CREAT: in a sticky folder such as /run/lock the kernel (fs.protected_regular)
/// refuses O_CREAT on files of other users, even for root.
int open_or_create(const char* path) {
  constexpr int kFlags = O_CLOEXEC | O_NOFOLLOW;
  int fd = open(path, O_RDWR | kFlags);
  if (fd < 0 && errno == EROFS) fd = open(path, O_RDONLY | kFlags);  // enough for a lock
  if (fd >= 0 || errno != ENOENT) return fd;
  const int made = open(path, O_RDWR | O_CREAT | O_EXCL | kFlags, kLockMode);
  return made < 0 && errno == EEXIST ? open(path, O_RDWR | kFlags) : made;
}

/// The owner removes its file at its end; a lock on a removed file is void.
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
  unlink(path_.c_str());  // while still locked; see is_still_at
  close(fd_);
}

bool InstanceLock::take(const char* path, const std::string& what, FileMessage& error) {
  constexpr int kTries = 11;
  constexpr std::int64_t kPauseNs = kNanosecondsPerSecond / 10;
  for (int i = 0; i < kTries; ++i) {
    const LockAttempt result = try_once(path);
    if (result == LockAttempt::kTaken) {
      path_ = FixedText<639>(path);
      leave_pid();
      return true;
    }
    if (result == LockAttempt::kFailed) return explain(path, error);
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kPauseNs);
  }
  FileMessage stranger;
  const bool is_strangers = !check_file_owner(path, stranger);
  error = FileMessage(formatted(
      "%s is in use by another program (process %d, lock %s), also reading needs "
      "exclusive access: stop that program, or use bess-edge status%s%s",
      what.c_str(), lock_owner_pid(path), path, is_strangers ? "; " : "", stranger.c_str()));
  return false;
}

InstanceLock::LockAttempt InstanceLock::try_once(const char* path) {
  const int fd = open_or_create(path);
  if (fd < 0) return LockAttempt::kFailed;
  if (flock(fd, LOCK_EX | LOCK_NB) != 0 || !is_still_at(fd, path)) {
    close(fd);
    return LockAttempt::kHeld;  // or its file was just removed: the next try makes a new one
  }
  struct stat info {};
  if (fstat(fd, &info) == 0 && is_trusted(info.st_uid)) {
    fd_ = fd;
    return LockAttempt::kTaken;
  }
  close(fd);
  errno = EACCES;  // its owner could lock or remove it at any time
  return LockAttempt::kFailed;
}

/// True after a disk error, which does not prevent control.
bool InstanceLock::explain(const char* path, FileMessage& error) {
  const int cause = errno;
  static_cast<void>(fail_with_errno(path, "cannot create the lock", error));
  if (is_disk_trouble(cause)) {
    report(JournalLevel::kWarning, "note: %s: continuing without it", error.c_str());
    error = {};
    return true;
  }
  if (cause == EACCES && check_file_owner(path, error)) {
    static_cast<void>(check_root_leftover(path, error));
  }
  return false;
}

void InstanceLock::leave_pid() const {
  fchmod(fd_, kLockMode);  // older versions let all users write
  char text[16];
  const int length = std::snprintf(text, sizeof text, "%d\n", static_cast<int>(getpid()));
  const bool written = ftruncate(fd_, 0) == 0 && pwrite(fd_, text, length, 0) == length;
  static_cast<void>(written);  // only for the message of a second program
}

int lock_owner_pid(const char* path) {
  if (!is_believable(path)) return 0;
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return errno == EACCES ? kOwnerHidden : 0;
  int holder = 0;
  if (flock(fd, LOCK_SH | LOCK_NB) != 0) holder = pid_in(fd);
  // On a read-only disk the file keeps an old process id.
  if (holder > 0 && kill(holder, 0) != 0 && errno == ESRCH) holder = -1;
  close(fd);
  return holder;
}

}  // namespace bess
