#include "edge/storage/limit_file.h"

#include <cerrno>

#include "edge/log/whole_file.h"

namespace bess {

Status LimitFile::read(OutsideLimit& limit, bool& is_set) const {
  is_set = false;
  char text[kLimitBytesMax + 1];
  const ssize_t size = read_beginning(path_, text, Links::kFollowed);
  if (size < 0 && errno == ENOENT) return Status::kOk;
  if (size < 0 || size > static_cast<ssize_t>(kLimitBytesMax)) return Status::kMalformed;
  const Status status = parse_outside_limit({text, static_cast<std::size_t>(size)}, limit);
  is_set = status == Status::kOk;
  return status;
}

}  // namespace bess
