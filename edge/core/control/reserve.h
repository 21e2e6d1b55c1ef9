// The backup reserve: a state of charge that is kept for a black-out, by the hour of the local day
// and, where wanted, by month. Apart from soc_min, which is for the battery's health. Pure
// integers.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

struct ReservePeriod {
  static constexpr std::uint16_t kEveryMonth = 0x0FFF;

  std::int16_t from_minute = 0;             ///< of the local day, wall clock
  std::int16_t to_minute = kMinutesPerDay;  ///< before it; below `from_minute`: over midnight
  std::int16_t soc_e4 = 0;
  std::uint16_t months = kEveryMonth;  ///< bit 0 is January: of the day on which the minute lies

  [[nodiscard]] constexpr bool holds_at(const LocalMinute& now) const {
    if ((months >> (now.month - 1) & 1) == 0) return false;
    const bool is_after = now.minute_of_day >= from_minute;
    const bool is_before = now.minute_of_day < to_minute;
    return from_minute < to_minute ? is_after && is_before : is_after || is_before;
  }
};

using ReservePlan = StaticVector<ReservePeriod, 24>;

/// The highest reserve of the periods that hold now; 0 = none.
constexpr std::int16_t reserve_soc_e4_at(const ReservePlan& plan, const LocalMinute& now) {
  std::int16_t reserve_e4 = 0;
  for (const ReservePeriod& period : plan) {
    if (period.soc_e4 > reserve_e4 && period.holds_at(now)) reserve_e4 = period.soc_e4;
  }
  return reserve_e4;
}

}  // namespace bess
