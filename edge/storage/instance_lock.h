// One controller to one battery, one to one state folder: an advisory lock (flock) on a file that
// names the process holding it. The kernel gives the lock back when a process ends, however it
// ends; a file that is left behind means nothing.
#pragma once

#include "edge/log/whole_file.h"
#include "shared/fixed_text.h"

namespace bess {

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

}  // namespace bess
