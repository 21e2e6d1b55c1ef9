#include "workstation/chain/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>
#include <cstring>

#include "shared/host/user_error.h"

namespace bess {
namespace {

[[noreturn]] void at_work(const std::filesystem::path& place) {
  fail("{}: another bess-train is at work here; wait for it, or give another --out",
       place.string());
}

/// A file system that gives no lock, as many a cluster's: whoever works there must know.
void warn_unlocked(const std::filesystem::path& place) {
  fmt::print(stderr,
             "bess-train: warning: {}: its file system gives no lock ({}): nothing keeps another "
             "bess-train from working here at the same time [no-lock]\n",
             place.string(), std::strerror(errno));
}

/// The lock file of a program that ended is taken away by it: a lock on what is no longer there is
/// none.
bool is_still_there(int fd, const std::filesystem::path& path) {
  struct stat held {};
  struct stat named {};
  return fstat(fd, &held) == 0 && stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, Of what)
    : fd_(open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  const int kind = what == Of::kFolder ? LOCK_EX : LOCK_SH;
  if (fd_.get() < 0 || flock(fd_.get(), kind | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) at_work(folder);
  warn_unlocked(folder);
}

FileLock::FileLock(const std::filesystem::path& file) : path_(file.string() + ".lock") {
  do {
    fd_.emplace(open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (fd_->get() < 0) return;  // whether it can be written is asked elsewhere
    if (flock(fd_->get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) at_work(file);
      warn_unlocked(file);
      return;
    }
  } while (!is_still_there(fd_->get(), path_));
}

FileLock::~FileLock() {
  if (fd_->get() >= 0) unlink(path_.c_str());
}

}  // namespace bess
