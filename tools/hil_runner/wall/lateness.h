// How late this machine wakes whoever sleeps, at worst, while this object lives.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>

#include "shared/scaled_clock.h"

namespace bess {

class Lateness {
 public:
  Lateness() : thread_([this] { run(); }) {}
  Lateness(const Lateness&) = delete;
  Lateness& operator=(const Lateness&) = delete;
  ~Lateness() {
    is_ending_ = true;
    thread_.join();
  }
  [[nodiscard]] double worst_s() const { return static_cast<double>(worst_ns_) / 1e9; }

 private:
  void run() {
    constexpr std::int64_t kTickNs = 5'000'000;
    while (!is_ending_) {
      const std::int64_t due_ns = clock_ns(CLOCK_MONOTONIC) + kTickNs;
      while (clock_ns(CLOCK_MONOTONIC) < due_ns) sleep_until_monotonic(due_ns);
      worst_ns_ = std::max(worst_ns_.load(), clock_ns(CLOCK_MONOTONIC) - due_ns);
    }
  }

  std::atomic<std::int64_t> worst_ns_ = 0;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace bess
