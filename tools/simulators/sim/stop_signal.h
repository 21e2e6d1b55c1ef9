// SIGTERM and SIGINT as a file descriptor, so that servers end their loops in order.
#pragma once

#include <pthread.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "shared/file_descriptor.h"

namespace bess {

class StopSignal {
 public:
  /// Construct before any thread starts, so that all threads block these signals.
  StopSignal() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    fd_ = FileDescriptor(signalfd(-1, &set, SFD_CLOEXEC));
  }

  /// Readable once a stop was requested.
  [[nodiscard]] int fd() const { return fd_.get(); }
  /// Blocks until a stop is requested.
  void wait() const {
    signalfd_siginfo info;
    while (read(fd(), &info, sizeof info) != sizeof info) continue;
  }

 private:
  FileDescriptor fd_;
};

}  // namespace bess
