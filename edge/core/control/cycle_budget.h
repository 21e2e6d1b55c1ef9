// Full-cycle budget of the day: SoC moved so far against the operator's limit. A full cycle is 100
// % charged and 100 % discharged, as in training. Pure integers; days are local.
#pragma once

#include <bit>
#include <cstdint>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

// Reversal cap: changes between charging and discharging in the last hour, against the operator's
// limit. It bounds the damage of a wrong price source. Idle steps in between neither add nor remove
// a reversal. Pure integers; one bit per step of the hour.

inline constexpr int kStepsPerHour = 60 / kMinutesPerStep;

/// State for a restart, at the record's time.
struct ReversalHistory {
  std::uint32_t steps = 0;     ///< bit n: the order n steps ago was a reversal
  std::int16_t direction = 0;  ///< sign of the last order that was not 0 W
  std::int16_t in_hour = 0;    ///< reversals among the steps
};

class ReversalCap {
 public:
  /// 0 = no cap.
  explicit constexpr ReversalCap(std::int32_t per_hour_max) : per_hour_max_(per_hour_max) {}

  constexpr void restore(const ReversalHistory& before, std::int64_t utc_s) {
    history_ = before;
    step_ = utc_s / kSecondsPerStep;
  }

  /// Called once per control cycle, before its decision. A clock step backwards keeps the history.
  constexpr void advance(std::int64_t utc_s) {
    const std::int64_t step = utc_s / kSecondsPerStep;
    const std::int64_t passed = step > step_ ? step - step_ : 0;
    step_ = step;
    history_.steps = passed < kStepsPerHour ? (history_.steps << passed) & kHourMask : 0;
    count();
  }

  /// Sign of the power that would exceed the cap; 0 = both are allowed.
  [[nodiscard]] constexpr int barred_direction() const {
    const bool is_spent = per_hour_max_ > 0 && history_.in_hour >= per_hour_max_;
    return is_spent ? -history_.direction : 0;
  }

  /// The order of this step.
  constexpr void note(std::int32_t power_w) {
    const int direction = power_w > 0 ? 1 : power_w < 0 ? -1 : 0;
    if (direction == 0) return;
    if (direction == -history_.direction) history_.steps |= 1U;
    history_.direction = static_cast<std::int16_t>(direction);
    count();
  }

  [[nodiscard]] constexpr const ReversalHistory& history() const { return history_; }

 private:
  static constexpr std::uint32_t kHourMask = (std::uint32_t{1} << kStepsPerHour) - 1;
  static_assert(kStepsPerHour < 32);

  constexpr void count() {
    history_.in_hour = static_cast<std::int16_t>(std::popcount(history_.steps));
  }

  std::int32_t per_hour_max_;
  ReversalHistory history_;
  std::int64_t step_ = 0;
};

/// State for a restart: local day as 20231126, and sum of |dSoC| in 1e-4 on that day.
struct DayThroughput {
  std::int32_t local_day = 0;
  std::int32_t soc_moved_e4 = 0;
};

class CycleBudget {
 public:
  /// `cycles_per_day_max_e4` in 1e-4 full cycles; 0 = no budget.
  explicit constexpr CycleBudget(std::int32_t cycles_per_day_max_e4)
      : cycles_per_day_max_e4_(cycles_per_day_max_e4) {}

  constexpr void restore(const DayThroughput& before) { today_ = before; }

  /// Called once per control cycle. Counts only movement under an order: neither the last-digit
  /// jitter of a resting battery nor its own mode.
  constexpr void update(std::int32_t local_day, std::int32_t soc_e4, bool was_driven) {
    if (local_day != today_.local_day) today_ = {.local_day = local_day};
    const std::int32_t moved_e4 = soc_e4 > soc_e4_ ? soc_e4 - soc_e4_ : soc_e4_ - soc_e4;
    if (was_driven && has_soc_) today_.soc_moved_e4 += moved_e4;
    soc_e4_ = soc_e4;
    has_soc_ = true;
  }
  /// After a link failure the next measurement has no predecessor.
  constexpr void forget_soc() { has_soc_ = false; }

  [[nodiscard]] constexpr bool is_spent() const {
    return cycles_per_day_max_e4_ > 0 && today_.soc_moved_e4 / 2 >= cycles_per_day_max_e4_;
  }
  [[nodiscard]] constexpr const DayThroughput& today() const { return today_; }

 private:
  std::int32_t cycles_per_day_max_e4_;
  DayThroughput today_;
  std::int32_t soc_e4_ = 0;
  bool has_soc_ = false;
};

}  // namespace bess
