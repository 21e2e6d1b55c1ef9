#include "edge/notify/notify_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/log/whole_file.h"
#include "edge/notify/journal_line.h"

namespace bess {
namespace {

/// A lock needs no writing: on a read-only disk the file of an earlier run will do.
int open_lock(const std::string& path) {
  constexpr int kFlags = O_CLOEXEC | O_NOFOLLOW;
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | kFlags, 0600);
  return fd >= 0 ? fd : open(path.c_str(), O_RDONLY | kFlags);
}

std::string holder_in(int fd) {
  char text[16] = {};
  long pid = 0;
  if (pread(fd, text, sizeof text - 1, 0) <= 0 || std::sscanf(text, "%ld", &pid) != 1) return "";
  return "process " + std::to_string(pid) + ", ";
}

}  // namespace

NotifyLock::~NotifyLock() {
  if (fd_ >= 0) close(fd_);
}

bool NotifyLock::take(const std::string& path, std::string& error) {
  make_folder(folder_of(path.c_str()).c_str());
  fd_ = open_lock(path);
  if (fd_ < 0) {
    say(JournalLevel::kWarning,
        path + ": cannot be made (" + std::strerror(errno) + "): a second notifier is not noticed");
    return true;
  }
  if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    error = "another bess-notify watches with this [notify] folder (" + holder_in(fd_) + "lock " +
            path + "): two would tell everything twice; stop that one, or give this one a folder";
    return false;
  }
  const std::string pid = std::to_string(getpid()) + "\n";
  const bool is_told = ftruncate(fd_, 0) == 0 &&
                       pwrite(fd_, pid.data(), pid.size(), 0) == static_cast<ssize_t>(pid.size());
  static_cast<void>(is_told);  // only for the message of the next one who comes
  return true;
}

}  // namespace bess
