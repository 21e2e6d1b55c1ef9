// Locks on folders and files, released when the program ends; and interruption by signals.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "shared/file_descriptor.h"

namespace bess {

// Ctrl-C and SIGTERM. Files appear complete or not at all. A command without state to save ends
// immediately; others see a flag, and a second signal ends them immediately.

/// From now on, signals end the program immediately with exit code 3, remove unfinished files and
/// print `note`: one line on what is kept and how to continue.
void end_when_interrupted(const std::string& note = "");

/// From now on, the first signal only sets the flag: a loop polls it, saves its state and returns.
/// The second ends the program immediately with exit code 130.
void watch_interruption();
std::atomic<bool>& interruption();

/// The flag as a function. Its first call starts watching: before that a loop has no state to save.
std::function<bool()> watch_from_first_call();

/// Returns within 0.1 s after an interruption.
void sleep_unless(double seconds, const std::atomic<bool>& interrupted);

class FolderLock {
 public:
  /// Exclusive use of the folder, or shared use by writers of single files.
  enum class LockScope : std::uint8_t { kFolder, kOneFile };

  /// Throws UserError when another program owns it; kFolder excludes all others. Only warns on a
  /// file system without locks.
  explicit FolderLock(const std::filesystem::path& folder, LockScope what = LockScope::kFolder);

 private:
  FileDescriptor fd_;
};

/// Lock of one output file by NAME.lock in its folder, which is deleted with the lock.
class FileLock {
 public:
  /// Throws UserError when another program owns it.
  explicit FileLock(const std::filesystem::path& file);
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  std::filesystem::path path_;
  std::optional<FileDescriptor> fd_;
};

}  // namespace bess
