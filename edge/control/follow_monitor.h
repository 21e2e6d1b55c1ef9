// Does the battery do what it is told? Registers that read back as written prove only that they
// were stored: some batteries acknowledge and do nothing, and a map with a wrong sign charges when
// it should discharge. Pure integers, fed once a cycle with the order that was in force.
#pragma once

#include <cstdint>

namespace bess {

class FollowMonitor {
 public:
  static constexpr std::int32_t kCyclesToTrip = 3;
  /// Less than this is the battery's own consumption or its meter's error, not an answer.
  static constexpr std::int32_t kNoiseW = 100;

  constexpr void observe(std::int32_t ordered_power_w, std::int32_t measured_power_w) {
    const bool is_driven = magnitude(ordered_power_w) > kNoiseW;
    const bool answers = magnitude(measured_power_w) > noise_w(ordered_power_w);
    const bool opposes = is_driven && answers && (ordered_power_w > 0) != (measured_power_w > 0);
    opposing_cycles_ = opposes ? opposing_cycles_ + 1 : 0;
    if (opposing_cycles_ >= kCyclesToTrip) tripped_ = true;
    unanswered_orders_ = is_driven && !answers ? unanswered_orders_ + 1 : 0;
  }

  /// The battery has gone the other way for kCyclesToTrip orders in a row. Stays until a restart:
  /// map, sign or wiring are wrong, and no later measurement can mend that.
  [[nodiscard]] constexpr bool has_tripped() const { return tripped_; }
  /// Orders in a row without any answer; a full, empty or cold battery does that too.
  [[nodiscard]] constexpr std::int32_t unanswered_orders() const { return unanswered_orders_; }

 private:
  static constexpr std::int32_t magnitude(std::int32_t power_w) {
    return power_w < 0 ? -power_w : power_w;
  }
  /// A tenth of the order, so that house loads seen by a poor meter do not count as an answer.
  static constexpr std::int32_t noise_w(std::int32_t ordered_power_w) {
    const std::int32_t tenth_w = magnitude(ordered_power_w) / 10;
    return tenth_w > kNoiseW ? tenth_w : kNoiseW;
  }

  std::int32_t opposing_cycles_ = 0;
  std::int32_t unanswered_orders_ = 0;
  bool tripped_ = false;
};

}  // namespace bess
