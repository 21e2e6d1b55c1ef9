// How far the state of charge has been moved today, against the operator's cycle budget. A cycle is
// 100 % of charge moved in and 100 % moved out, as in training. Pure integers; the day is local.
#pragma once

#include <cstdint>

#include "shared/local_day.h"

namespace bess {

/// What a restart takes over: the local day as 20231126, and the sum of |dSoC| in 1e-4 on it.
struct DayThroughput {
  std::int32_t local_day = 0;
  std::int32_t soc_moved_e4 = 0;
};

class CycleBudget {
 public:
  /// `cycles_per_day_max_e4` in 1e-4 cycles; 0 = no budget.
  explicit constexpr CycleBudget(std::int32_t cycles_per_day_max_e4)
      : cycles_per_day_max_e4_(cycles_per_day_max_e4) {}

  constexpr void restore(const DayThroughput& before) { today_ = before; }

  /// Once a cycle. Only what was moved under an order counts: neither the jitter of a resting
  /// battery's last digit nor what the battery does in its own mode is ours.
  constexpr void update(std::int32_t local_day, std::int32_t soc_e4, bool was_driven) {
    if (local_day != today_.local_day) today_ = {.local_day = local_day};
    const std::int32_t moved_e4 = soc_e4 > soc_e4_ ? soc_e4 - soc_e4_ : soc_e4_ - soc_e4;
    if (was_driven && has_soc_) today_.soc_moved_e4 += moved_e4;
    soc_e4_ = soc_e4;
    has_soc_ = true;
  }
  /// The next measurement has no predecessor: the link was down meanwhile.
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
