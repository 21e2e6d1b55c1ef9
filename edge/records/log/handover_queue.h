// Fixed-size queue to a thread of its own: the producer never waits, locks or allocates; the thread
// sleeps until an item arrives. It decouples the control thread from the disk.
#pragma once

#include <semaphore.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>

#include "edge/core/memory/plain_thread.h"

namespace bess {

template <typename T, std::size_t kCapacity>
class HandoverQueue {
 public:
  HandoverQueue() { sem_init(&filled_, 0, 0); }
  HandoverQueue(const HandoverQueue&) = delete;
  HandoverQueue& operator=(const HandoverQueue&) = delete;
  ~HandoverQueue() { sem_destroy(&filled_); }

  /// Starts the thread, which calls `(owner->*kTake)(item)` for each item.
  template <auto kTake, typename Owner>
  void start(Owner* owner) {
    owner_ = owner;
    thread_.template start<&HandoverQueue::template run<kTake, Owner>>(this);
  }
  /// False when the queue is full; the item is dropped.
  bool push(const T& item) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kCapacity) return false;
    slots_[end % kCapacity] = item;
    end_.store(end + 1, std::memory_order_release);
    sem_post(&filled_);
    return true;
  }
  /// Ends the thread, if it was started, after the last item.
  void finish() {
    if (!thread_.is_running()) return;
    ending_ = true;
    sem_post(&filled_);
    thread_.join();
  }

 private:
  template <auto kTake, typename Owner>
  void run() {
    T item;
    while (true) {
      if (wait_and_pop(item)) {
        (static_cast<Owner*>(owner_)->*kTake)(item);
      } else if (ending_) {
        return;
      }
    }
  }
  /// False when woken with an empty queue.
  bool wait_and_pop(T& item) {
    while (sem_wait(&filled_) != 0 && errno == EINTR) continue;
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    item = slots_[begin % kCapacity];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

  std::array<T, kCapacity> slots_{};
  std::atomic<std::size_t> begin_{0};  ///< moved by the consumer
  std::atomic<std::size_t> end_{0};    ///< moved by the producer
  std::atomic<bool> ending_{false};
  sem_t filled_{};
  void* owner_ = nullptr;
  PlainThread thread_;
};

}  // namespace bess
