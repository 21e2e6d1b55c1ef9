// When to ask for the row of a minute: as soon as the source usually has it, and no more often than
// it allows. Pure; seconds of the edge's clock behind the tick.
#pragma once

#include <algorithm>
#include <cstdint>

namespace bess {

class AskTiming {
 public:
  AskTiming(std::int32_t wait_s, std::int32_t requests_per_cycle)
      : wait_s_(wait_s), spacing_s_(std::max(wait_s / requests_per_cycle, 1)) {}

  /// Of the first request of a cycle.
  [[nodiscard]] std::int32_t first_s() const { return delay_s_; }
  [[nodiscard]] std::int32_t spacing_s() const { return spacing_s_; }

  /// How a cycle went: whether its first request found the row, whether one was refused as too
  /// many. A source that refuses is not tried earlier again.
  void learn(bool is_found_at_once, bool is_refused) {
    constexpr int kCyclesBeforeEarlier = 30;
    constexpr std::int32_t kLaterS = 3, kLeastLeftS = 2;
    has_refused_ = has_refused_ || is_refused;
    if (!is_found_at_once) {
      delay_s_ = std::min(delay_s_ + kLaterS, std::max(wait_s_ - kLeastLeftS, 0));
      good_cycles_ = 0;
    } else if (!has_refused_ && delay_s_ > 0 && ++good_cycles_ >= kCyclesBeforeEarlier) {
      --delay_s_;
      good_cycles_ = 0;
    }
  }

 private:
  std::int32_t wait_s_;
  std::int32_t spacing_s_;
  std::int32_t delay_s_ = 0;
  int good_cycles_ = 0;
  bool has_refused_ = false;
};

}  // namespace bess
