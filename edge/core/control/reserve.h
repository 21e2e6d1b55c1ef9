// Backup reserve: state of charge kept for a power failure, by local hour and optionally by month.
// Independent of soc_min, which protects the battery. Pure integers.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

struct ReservePeriod {
  static constexpr std::uint16_t kEveryMonth = 0x0FFF;

  std::int16_t from_minute = 0;             ///< of the local day, wall clock
  std::int16_t to_minute = kMinutesPerDay;  ///< exclusive; below `from_minute`: over midnight
  std::int16_t soc_e4 = 0;
  std::uint16_t months = kEveryMonth;  ///< bit 0 is January: month of the minute's day

  [[nodiscard]] constexpr bool holds_at(const LocalMinute& now) const {
    if ((months >> (now.month - 1) & 1) == 0) return false;
    const bool is_after = now.minute_of_day >= from_minute;
    const bool is_before = now.minute_of_day < to_minute;
    return from_minute < to_minute ? is_after && is_before : is_after || is_before;
  }
};

using ReservePlan = StaticVector<ReservePeriod, 24>;

/// The highest reserve of the current periods; 0 = none.
constexpr std::int16_t reserve_soc_e4_at(const ReservePlan& plan, const LocalMinute& now) {
  std::int16_t reserve_e4 = 0;
  for (const ReservePeriod& period : plan) {
    if (period.soc_e4 > reserve_e4 && period.holds_at(now)) reserve_e4 = period.soc_e4;
  }
  return reserve_e4;
}

}  // namespace bess
