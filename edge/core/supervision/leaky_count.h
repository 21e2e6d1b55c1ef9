// Leaky count for intermittent faults: a bad reading weighs three times a good one.
//
//   level <- min(level + 3, 6) on a bad reading, max(level - 1, 0) on a good one; found: level >= 5
//
//   every reading bad       3 6                found by the 2nd bad one, after 2 readings
//   every other one         3 2 5              found by the 2nd, after 3
//   every third one         3 2 1 4 3 2 5      found by the 3rd, after 7
//   every fourth or rarer   3 2 1 0 3 ...      never: three good readings forgive a bad one,
//                                              but found by its energy (energy_balance.h)
#pragma once

#include <algorithm>
#include <cstdint>

namespace bess {

struct LeakyCount {
  static constexpr std::int16_t kBadWeight = 3;
  static constexpr std::int16_t kFound = 5;
  /// Capped: a day of bad readings is forgiven as fast as two.
  static constexpr std::int16_t kMost = 2 * kBadWeight;

  constexpr void bad() {
    level = std::min<std::int16_t>(static_cast<std::int16_t>(level + kBadWeight), kMost);
  }
  constexpr void good() {
    if (level > 0) --level;
  }
  [[nodiscard]] constexpr bool is_found() const { return level >= kFound; }
  constexpr void forget() { level = 0; }

  std::int16_t level = 0;

  friend constexpr bool operator==(const LeakyCount&, const LeakyCount&) = default;
};

}  // namespace bess
