// When to ask for the row of a minute: as soon as the source usually has it, and no more often than
// it allows. Pure; seconds of the edge's clock behind the tick.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/prices/price_settings.h"

namespace bess {

class AskTiming {
 public:
  /// Of the first request of a cycle.
  [[nodiscard]] std::int32_t first_s() const { return delay_s_; }
  [[nodiscard]] static std::int32_t spacing_s() { return kPriceWait_s / kPriceRequests; }

  /// How a cycle went: whether its first request found the row, whether one was refused as too
  /// many. A source that refuses is not tried earlier again.
  void learn(bool is_found_at_once, bool is_refused) {
    constexpr int kCyclesBeforeEarlier = 30;
    constexpr std::int32_t kLaterS = 3, kLeastLeftS = 2;
    has_refused_ = has_refused_ || is_refused;
    if (!is_found_at_once) {
      delay_s_ = std::min(delay_s_ + kLaterS, kPriceWait_s - kLeastLeftS);
      good_cycles_ = 0;
    } else if (!has_refused_ && delay_s_ > 0 && ++good_cycles_ >= kCyclesBeforeEarlier) {
      --delay_s_;
      good_cycles_ = 0;
    }
  }

 private:
  std::int32_t delay_s_ = 0;
  int good_cycles_ = 0;
  bool has_refused_ = false;
};

}  // namespace bess
