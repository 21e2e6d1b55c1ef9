// SIGTERM and SIGINT of a companion program, taken by a thread of their own, so that nothing is cut
// in the middle.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <functional>
#include <thread>

namespace bess {

class StopSignals {
 public:
  /// Before any other thread, which would not have them blocked. `on_stop` is called once, on the
  /// thread: at a signal, otherwise in the destructor.
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
  /// A connection that the other side closes is an error to handle, not an end, too.
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
