// One notifier to one memory: two would tell everything twice, and each would forget what the other
// told.
#pragma once

#include <string>

#include "shared/file_descriptor.h"

namespace bess {

/// A flock: the kernel gives it back however the process ends. Its file stays.
class NotifyLock {
 public:
  NotifyLock() = default;
  NotifyLock(const NotifyLock&) = delete;
  NotifyLock& operator=(const NotifyLock&) = delete;
  ~NotifyLock();

  /// Makes the folder if it is missing. False with one line where another notifier holds it; where
  /// the disk does not let it be made, nothing is refused: an alarm that is told twice is better
  /// than none.
  bool take(const std::string& path, std::string& error);

 private:
  int fd_ = -1;
};

}  // namespace bess
