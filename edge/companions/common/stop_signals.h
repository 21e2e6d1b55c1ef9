// Stop signals SIGTERM and SIGINT of a companion program, received by a separate thread, so that no
// work is interrupted.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <functional>
#include <thread>

namespace bess {

class StopSignals {
 public:
  /// Construct before any other thread, which inherits the blocked signals. `on_stop` is called
  /// once by the thread: at a signal, or in the destructor.
  explicit StopSignals(std::function<void()> on_stop)
      : thread_([signals = block(), on_stop = std::move(on_stop)] {
          int ignored = 0;
          sigwait(&signals, &ignored);
          on_stop();
        }) {}
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals() {
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }

 private:
  /// Also ignores SIGPIPE: a closed connection is an error to handle, not an end.
  static sigset_t block() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    signal(SIGPIPE, SIG_IGN);
    return signals;
  }

  std::thread thread_;
};

}  // namespace bess
