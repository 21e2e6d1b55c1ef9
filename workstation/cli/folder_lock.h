// One program at a time works in a folder. The lock is the folder's own: it leaves no file, and ends with the
// program however that ends.
#pragma once

#include <filesystem>

#include "shared/file_descriptor.h"

namespace bess {

class FolderLock {
 public:
  /// Throws UserError when another program holds it. A file system without locks gives none.
  explicit FolderLock(const std::filesystem::path& folder);

 private:
  FileDescriptor fd_;
};

}  // namespace bess
