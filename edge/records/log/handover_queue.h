// Fixed-size queue from one thread to another: the producer never waits, locks or allocates; the
// consumer sleeps until an item arrives. It decouples the control thread from the disk.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>

namespace bess {

template <typename T, std::size_t kCapacity>
class HandoverQueue {
 public:
  HandoverQueue() { sem_init(&filled_, 0, 0); }
  HandoverQueue(const HandoverQueue&) = delete;
  HandoverQueue& operator=(const HandoverQueue&) = delete;
  ~HandoverQueue() { sem_destroy(&filled_); }

  /// False when the queue is full; the item is dropped.
  bool push(const T& item) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kCapacity) return false;
    slots_[end % kCapacity] = item;
    end_.store(end + 1, std::memory_order_release);
    sem_post(&filled_);
    return true;
  }
  /// Wakes the consumer without an item.
  void wake() { sem_post(&filled_); }

  /// Waits for an item or a wake-up; false after a wake-up with an empty queue.
  bool wait_and_pop(T& item) {
    while (sem_wait(&filled_) != 0 && errno == EINTR) continue;
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    item = slots_[begin % kCapacity];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, kCapacity> slots_{};
  std::atomic<std::size_t> begin_{0};  ///< moved by the consumer
  std::atomic<std::size_t> end_{0};    ///< moved by the producer
  sem_t filled_{};
};

}  // namespace bess
