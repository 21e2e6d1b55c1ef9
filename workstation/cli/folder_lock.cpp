#include "workstation/cli/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>

#include "shared/host/user_error.h"

namespace bess {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : fd_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (fd_.get() < 0 || flock(fd_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  fail("{}: another bess-train is at work here; wait for it, or give another folder",
       folder.string());
}

}  // namespace bess
