// One controller to one battery, one to one state folder: an advisory lock (flock) on a file that
// names the process holding it. The kernel returns the lock when a process ends, however it ends; a
// file that is left behind means nothing. Lock and status files of other users are rejected.
#pragma once

#include <sys/stat.h>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/whole_file.h"
#include "shared/fixed_text.h"

namespace bess {

// Owners of files: a lock or a status that any user could have put there would keep the controller
// from starting, or report one that has long ended.

/// Root, and the user of this process.
bool is_trusted(uid_t owner);

/// "PATH belongs to user N, ...", with the mend.
FileMessage strangers_file(const char* path);

/// For a file that this process is going to rely on or to replace: false with one line when it is
/// there and belongs to a stranger. A link is looked at itself.
bool refuse_stranger(const char* path, FileMessage& error);

/// For a file of root's that this process may not open: false with one line that names the command
/// which removes it.
bool refuse_roots_leftover(const char* path, FileMessage& error);

/// For a file that is only read: also of whoever owns its folder, who can put anything there. A
/// file that is not there is nobody's.
bool is_believable(const char* path);

class InstanceLock {
 public:
  InstanceLock() = default;
  InstanceLock(const InstanceLock&) = delete;
  InstanceLock& operator=(const InstanceLock&) = delete;
  ~InstanceLock();

  /// Tries for a second, because a predecessor may be on its way out and `holder_of` looks by
  /// locking. False with one line; `what` names the locked thing in it. A lock file of another
  /// user, root apart, is refused: he could take it away. On a full or read-only disk it goes on
  /// without a lock, and says so.
  bool take(const char* path, const char* what, FileMessage& error);

 private:
  enum class Try { kTaken, kHeld, kFailed };  ///< kFailed with errno set

  Try try_once(const char* path);
  static bool explain(const char* path, FileMessage& error);
  void leave_pid() const;

  FixedText<639> path_;
  int fd_ = -1;
};

inline constexpr int kHolderHidden = -2;

/// Process that holds the lock, 0 = nobody, or nobody who is to be believed; -1 = somebody whose
/// number is unknown; kHolderHidden = this user may not ask.
int holder_of(const char* path);

// What a controller must have for itself before it does anything: its battery and its state folder.

/// Lock of the battery: the same name for every configuration that leads to it.
FixedText<639> battery_lock_path(const EdgeConfig& config);
/// Of [battery] name: two controllers of one machine must not report under the same.
FixedText<639> name_lock_path(const EdgeConfig& config);
/// Where every controller of this machine locks its battery; no configuration leads past it.
std::string_view lock_folder();
/// Process of the controller of this configuration, as `holder_of` has it: by the lock of its state
/// folder or, where that could not be made there, of its run folder.
int controller_holding(const EdgeConfig& config);
bool is_controller_running(const EdgeConfig& config);

struct RunLocks {
  InstanceLock battery;
  InstanceLock name;
  InstanceLock state;
  InstanceLock run;  ///< where there is a run folder
};

/// --check needs the battery alone. False with one line.
bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error);
/// Makes state and run folder if they are missing; refuses files of another user in them. A run
/// folder that cannot be made is told and no reason to fail.
bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error);

}  // namespace bess
