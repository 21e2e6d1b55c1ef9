// The newest value of a kind from one thread to another, larger than a word: of three places one is
// being written, one being read, and one holds what was posted last. Neither side ever waits.
#pragma once

#include <atomic>
#include <cstdint>

namespace bess {

template <typename Value>
class Mailbox {
 public:
  /// The writer's place, with what it held some posts ago.
  Value& draft() { return places_[writing_]; }
  void post() {
    writing_ = handed_over_.exchange(static_cast<std::uint8_t>(writing_ | kNew),
                                     std::memory_order_acq_rel) &
               kPlace;
  }
  /// The reader's: what was posted last; before anything was, a value by default.
  const Value& latest() {
    if ((handed_over_.load(std::memory_order_relaxed) & kNew) != 0) {
      reading_ = handed_over_.exchange(reading_, std::memory_order_acq_rel) & kPlace;
    }
    return places_[reading_];
  }

 private:
  static constexpr std::uint8_t kPlace = 3, kNew = 4;

  Value places_[3]{};
  std::atomic<std::uint8_t> handed_over_{0};
  std::uint8_t writing_ = 1, reading_ = 2;
};

}  // namespace bess
