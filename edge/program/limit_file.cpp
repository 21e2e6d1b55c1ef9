#include "edge/program/limit_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace bess {

Status LimitFile::read(OutsideLimit& limit, bool& is_set) const {
  is_set = false;
  const int fd = open(path_, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return errno == ENOENT ? Status::kOk : Status::kMalformed;
  struct stat facts {};
  char text[kLimitBytesMax + 1];
  const bool is_file = fstat(fd, &facts) == 0 && S_ISREG(facts.st_mode);
  const ssize_t size = is_file ? pread(fd, text, sizeof text, 0) : -1;
  close(fd);
  if (size < 0 || size > static_cast<ssize_t>(kLimitBytesMax)) return Status::kMalformed;
  const Status status = parse_outside_limit({text, static_cast<std::size_t>(size)}, limit);
  is_set = status == Status::kOk;
  return status;
}

}  // namespace bess
