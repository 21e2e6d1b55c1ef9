// A thread on a stack inside its owner: starting it maps no memory. Its lowest page is a guard, so
// an overflow ends the process instead of writing over the neighbour. For threads that live as long
// as the process.
#pragma once

#include <pthread.h>
#include <sys/mman.h>

#include <cstddef>

#include "edge/base/check.h"

namespace bess {

template <std::size_t kStackBytes>
class StaticThread {
  static_assert(kStackBytes % 4'096 == 0);

 public:
  StaticThread() = default;
  StaticThread(const StaticThread&) = delete;
  StaticThread& operator=(const StaticThread&) = delete;
  ~StaticThread() { BESS_CHECK(!is_running_); }

  void start(void* (*function)(void*), void* argument) {
    BESS_CHECK(!is_running_);
    BESS_CHECK(mprotect(memory_, kGuardBytes, PROT_NONE) == 0);
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    BESS_CHECK(pthread_attr_setstack(&attributes, memory_ + kGuardBytes, kStackBytes) == 0);
    BESS_CHECK(pthread_create(&thread_, &attributes, function, argument) == 0);
    pthread_attr_destroy(&attributes);
    is_running_ = true;
  }
  [[nodiscard]] bool is_running() const { return is_running_; }
  void join() {
    pthread_join(thread_, nullptr);
    mprotect(memory_, kGuardBytes, PROT_READ | PROT_WRITE);
    is_running_ = false;
  }

 private:
  static constexpr std::size_t kGuardBytes = 64 * 1024;  ///< one page of any kernel

  alignas(kGuardBytes) std::byte memory_[kGuardBytes + kStackBytes];
  pthread_t thread_{};
  bool is_running_ = false;
};

}  // namespace bess
