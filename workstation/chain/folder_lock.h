// One program at a time works in a folder. The lock is the folder's own: it leaves no file, and
// ends with the program however that ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "shared/file_descriptor.h"

namespace bess {

class FolderLock {
 public:
  /// Whoever works in the whole folder, and whoever writes one file of it.
  enum class Of : std::uint8_t { kFolder, kOneFile };

  /// Throws UserError when another program holds it: one in the whole folder excludes all others.
  /// On a file system without locks it warns, and locks nothing.
  explicit FolderLock(const std::filesystem::path& folder, Of what = Of::kFolder);

 private:
  FileDescriptor fd_;
};

/// One program at a time makes a file: the lock is a file NAME.lock beside it, which goes with the
/// lock.
class FileLock {
 public:
  /// Throws UserError when another program holds it.
  explicit FileLock(const std::filesystem::path& file);
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  std::filesystem::path path_;
  std::optional<FileDescriptor> fd_;
};

}  // namespace bess
