// Instance lock: one controller per battery and per state folder, by an advisory lock (flock) on a
// file with the process id. The kernel releases the lock when the process ends; a leftover file has
// no effect. Lock and status files of other users are rejected.
#pragma once

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/atomic_file.h"
#include "shared/fixed_text.h"

namespace bess {

// Owners of files: a lock or status of another user could prevent a start, or report a controller
// that has ended.

/// "PATH belongs to user N, ...", with the remedy.
FileMessage foreign_file_error(const char* path);

/// For a file that is only read: also accepts the owner of the folder, and a missing file.
bool is_believable(const char* path);

class InstanceLock {
 public:
  InstanceLock() = default;
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;
  ~InstanceLock();

  /// Tries for one second, because a predecessor may be ending and `lock_owner_pid` locks briefly.
  /// False with one line; `what` names the locked object. A lock file of another user except root
  /// is refused, because that user could remove it. On a full or read-only disk, a note and true.
  bool take(const char* path, const std::string& what, FileMessage& error);

 private:
  enum class LockAttempt { kTaken, kHeld, kFailed };  ///< kFailed with errno set

  LockAttempt try_once(const char* path);
  static bool explain(const char* path, FileMessage& error);
  void leave_pid() const;

  FixedText<639> path_;
  int fd_ = -1;
};

inline constexpr int kOwnerHidden = -2;

/// Process id of the lock's owner; 0 = none, or not trusted; -1 = unknown id; kOwnerHidden = no
/// permission to check.
int lock_owner_pid(const char* path);

/// Lock of the battery, the same for every configuration with this address.
FixedText<639> battery_lock_path(const EdgeConfig& config);
/// Lock of [battery] name: two controllers of one machine need different names.
FixedText<639> name_lock_path(const EdgeConfig& config);
/// Folder of the locks of all controllers of this machine, not configurable.
const char* lock_folder();
/// Process of the controller of this configuration, as `lock_owner_pid`: by the lock of its run
/// folder or its state folder.
int controller_holding(const EdgeConfig& config);
bool is_controller_running(const EdgeConfig& config);

struct RunLocks {
  InstanceLock battery;
  InstanceLock name;
  InstanceLock state;
  InstanceLock run;  ///< only with a run folder
};

/// Enough for --check. False with one line.
bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error);
/// Creates missing state and run folders and refuses files of another user in them. A run folder
/// that cannot be created is only reported.
bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error);

}  // namespace bess
