// Locks on a folder or a file, released with the program however it ends and without a file left
// behind; and interruption by a signal.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "shared/file_descriptor.h"

namespace bess {

// Ctrl-C and SIGTERM. Whatever is written appears complete or not at all, so that a command that
// has nothing to save ends at once; one that has is told, and a second signal ends it at once too.

/// From here on they end the program at once, with exit code 3: files being written are removed,
/// and `note` is said, one line on what is kept and how to go on.
void end_when_interrupted(const std::string& note = "");

/// From here on the first only raises the flag: a loop looks at it, saves what it has and returns.
/// The second ends the program at once, with exit code 130.
void watch_interruption();
std::atomic<bool>& interruption();

/// The flag as a question. Watching begins when it is asked for the first time: before that a loop
/// has nothing to save.
std::function<bool()> watched_from_the_first_look();

/// Returns within a tenth of a second once interrupted.
void sleep_unless(double seconds, const std::atomic<bool>& interrupted);

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
