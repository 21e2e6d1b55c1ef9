// SIGTERM and SIGINT of a companion program: blocked before any thread is there, and
// taken where it waits, so that nothing is cut in the middle.
#pragma once

#include <signal.h>

namespace bess {

/// A connection that is closed by the other side is an error to handle, not an end, too.
inline sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  return signals;
}

}  // namespace bess
