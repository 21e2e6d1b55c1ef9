// The file in which another program limits the battery (outside_limit.h has its line): read by the
// control thread every few seconds, so no heap, a fixed buffer, and nothing that could wait: a
// regular file on a memory file system (/run), never a pipe. Who writes it replaces it at once.
#pragma once

#include "edge/site/outside_limit.h"

namespace bess {

class LimitFile {
 public:
  /// `path` must outlive this object.
  explicit LimitFile(const char* path) : path_(path) {}

  /// `is_set` is false where there is no such file. kMalformed: it cannot be understood, or is
  /// there and cannot be read.
  Status read(OutsideLimit& limit, bool& is_set) const;

 private:
  const char* path_;
};

}  // namespace bess
