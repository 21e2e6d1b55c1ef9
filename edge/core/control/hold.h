// Operator's hold: a fixed power until an end time, independent of prices and student. It passes
// from the thread that reads its file to the control thread in one atomic word, so that neither
// waits for the other, nor the control thread for a disk.
#pragma once

#include <atomic>
#include <cstdint>

#include "shared/units_and_limits.h"

namespace bess {

inline constexpr std::int64_t kHoldSecondsMin = 120;  ///< shorter ones could fall between two ticks
inline constexpr std::int64_t kHoldSecondsMax = 7 * kSecondsPerDay;

/// The file's content when last read. No hold, or unreadable: no power and no end.
struct Hold {
  std::int32_t power_w = 0;  ///< charge positive
  /// UTC; 32 bits last until 2106. 0 = no hold.
  std::uint32_t until_utc_s = 0;
  bool unreadable = false;  ///< the file exists but is not a valid hold

  friend constexpr bool operator==(const Hold&, const Hold&) = default;
};

/// The hold's effect on a cycle, for the log.
struct HoldReport {
  bool held = false;
  bool unreadable = false;
  std::int32_t power_w = 0;
  std::uint32_t until_utc_s = 0;
};

/// An end time beyond the permitted maximum means a wrong clock, then or now: the hold is ignored
/// and reported as unreadable.
constexpr HoldReport hold_at(const Hold& hold, std::int64_t now_utc_s) {
  const std::int64_t left_s = std::int64_t{hold.until_utc_s} - now_utc_s;
  if (hold.unreadable || left_s > kHoldSecondsMax + kHoldSecondsMin) return {.unreadable = true};
  if (left_s <= 0) return {};
  return {.held = true, .power_w = hold.power_w, .until_utc_s = hold.until_utc_s};
}

/// The newest hold, from its reader to the control loop. Wait-free on both sides.
class LatestHold {
 public:
  void publish(const Hold& hold) {
    const std::uint64_t high = hold.unreadable ? kUnreadable : hold.until_utc_s;
    word_.store(high << 32 | static_cast<std::uint32_t>(hold.power_w), std::memory_order_relaxed);
  }
  [[nodiscard]] Hold latest() const {
    const std::uint64_t word = word_.load(std::memory_order_relaxed);
    if (word >> 32 == kUnreadable) return {.unreadable = true};
    return {.power_w = static_cast<std::int32_t>(static_cast<std::uint32_t>(word)),
            .until_utc_s = static_cast<std::uint32_t>(word >> 32)};
  }

 private:
  static constexpr std::uint64_t kUnreadable = UINT32_MAX;  ///< not a possible end time

  std::atomic<std::uint64_t> word_{0};
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
};

}  // namespace bess
