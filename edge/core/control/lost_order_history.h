// The newest orders that power was to flow by: which of them were lost before their end. Logged, so
// that a restart goes on counting; told by status, health and metrics.
#pragma once

#include <bit>
#include <cstdint>

namespace bess {

struct LostOrderHistory {
  static constexpr int kRemembered = 30;  ///< an hour of them

  std::uint32_t orders = 0;  ///< one bit each, 1 = lost, the newest in the lowest
  std::int16_t judged = 0;   ///< how many of the bits count, 0..30
  std::int16_t lost = 0;     ///< of these
  bool is_found = false;     ///< too many, and orders have not held for long enough since

  constexpr void note(bool is_lost) {
    constexpr std::uint32_t kMask = (1U << kRemembered) - 1;
    orders = (orders << 1 | (is_lost ? 1U : 0U)) & kMask;
    if (judged < kRemembered) ++judged;
    lost = static_cast<std::int16_t>(std::popcount(orders));
  }
  friend constexpr bool operator==(const LostOrderHistory&, const LostOrderHistory&) = default;
};

}  // namespace bess
