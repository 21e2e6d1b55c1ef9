// When the readings in a log were taken, without the steps of the clock of then: records bear
// ticks, and a clock that was stepped between two of them has made the time between them look
// shorter or longer. The age of the order that the battery followed was measured steadily, and
// tells.
#pragma once

#include <cstdint>

#include "edge/control/control_types.h"
#include "shared/units_and_limits.h"

namespace bess {

class RecalledTime {
 public:
  /// Of the next reading, oldest first, `read_lead_s` before its tick; in UTC, ahead of it by
  /// `ahead_s`.
  std::int64_t steady_s(const CycleRecord& record, std::int32_t read_lead_s) {
    const std::int64_t utc_s = record.utc_s - read_lead_s;
    if (utc_s_ == 0) utc_s_ = utc_s;
    const std::int64_t by_clock_s = utc_s - utc_s_;
    steady_ahead_s_ += elapsed_s(record.followed, by_clock_s, read_lead_s) - by_clock_s;
    utc_s_ = utc_s;
    followed_ = record.followed;
    return utc_s + steady_ahead_s_;
  }
  /// Of steady time before UTC, at the newest reading.
  [[nodiscard]] std::int64_t ahead_s() const { return steady_ahead_s_; }

 private:
  static constexpr std::int64_t kDoubtS =
      kSecondsPerStep / 2;                          ///< an order may wait that long for its price
  static constexpr std::int64_t kTooLongS = 3'600;  ///< nobody judges over such a gap

  [[nodiscard]] std::int64_t elapsed_s(const FollowedOrder& now, std::int64_t by_clock_s,
                                       std::int32_t read_lead_s) const {
    if (!now.is_judged || !followed_.is_judged) return by_clock_s;
    const bool goes_on = now.power_w == followed_.power_w && now.age_s > followed_.age_s;
    if (goes_on) return now.age_s - followed_.age_s;
    const std::int64_t by_age_s = std::int64_t{now.age_s} + read_lead_s;
    if (by_age_s > by_clock_s) return by_age_s;  // it cannot be older than the reading before
    // A step forward, or a reading that is missing: it is not known what flowed.
    return by_age_s < by_clock_s - kDoubtS ? by_clock_s + kTooLongS : by_clock_s;
  }

  std::int64_t utc_s_ = 0;  ///< of the reading before; 0 = none
  std::int64_t steady_ahead_s_ = 0;
  FollowedOrder followed_{};
};

}  // namespace bess
