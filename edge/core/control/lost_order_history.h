// Lost orders among the newest orders with power. Logged, so that a restart continues the count;
// shown by status, health and metrics.
#pragma once

#include <bit>
#include <cstdint>

namespace bess {

struct LostOrderHistory {
  static constexpr int kRemembered = 30;  ///< one hour

  std::uint32_t orders = 0;  ///< one bit per order, 1 = lost, newest in the lowest bit
  std::int16_t judged = 0;   ///< number of valid bits, 0..30
  std::int16_t lost = 0;     ///< lost orders among them
  bool is_found = false;     ///< finding: too many, and no long enough series held since

  constexpr void note(bool is_lost) {
    constexpr std::uint32_t kMask = (1U << kRemembered) - 1;
    orders = (orders << 1 | (is_lost ? 1U : 0U)) & kMask;
    if (judged < kRemembered) ++judged;
    lost = static_cast<std::int16_t>(std::popcount(orders));
  }
  friend constexpr bool operator==(const LostOrderHistory&, const LostOrderHistory&) = default;
};

}  // namespace bess
