// Thread with the default stack size of the process (heap_seal.h), started without this program's
// heap, so that the control path contains no allocator call.
#pragma once

#include <pthread.h>

#include "edge/core/base/check.h"

namespace bess {

class PlainThread {
 public:
  PlainThread() = default;
  PlainThread(const PlainThread&) = delete;
  PlainThread& operator=(const PlainThread&) = delete;
  ~PlainThread() { BESS_CHECK(!is_running_); }

  /// Runs `(owner->*kRun)()` on the thread.
  template <auto kRun, typename Owner>
  void start(Owner* owner) {
    BESS_CHECK(!is_running_);
    const auto run = [](void* self) -> void* {
      (static_cast<Owner*>(self)->*kRun)();
      return nullptr;
    };
    BESS_CHECK(pthread_create(&thread_, nullptr, run, owner) == 0);
    is_running_ = true;
  }
  [[nodiscard]] bool is_running() const { return is_running_; }
  void join() {
    pthread_join(thread_, nullptr);
    is_running_ = false;
  }

 private:
  pthread_t thread_{};
  bool is_running_ = false;
};

}  // namespace bess
