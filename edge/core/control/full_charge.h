// Full charge every N days, so that the battery management can balance its cells and recalibrate
// its SoC. Counts local days since the SoC was last full. After N days nothing is discharged, and
// the battery charges while the price is not above the trailing level; one day later it charges at
// any price. Pure integers.
#pragma once

#include <cstdint>

#include "shared/local_time.h"
#include "shared/price_level.h"
#include "shared/units_and_limits.h"

namespace bess {

enum class FullChargeRequest : std::uint8_t { kNone, kNoDischarge, kCharge };

/// Days since 1970 of a local date.
inline std::int32_t local_day_number(const LocalMinute& now) {
  const std::int64_t midnight_s = utc_from_civil({now.year, now.month, now.day, 0, 0, 0});
  return static_cast<std::int32_t>(midnight_s / kSecondsPerDay);
}

/// Local day of the last full charge, from the newest record of an earlier run; 0 = no record.
inline std::int32_t last_full_day_of(std::int64_t record_utc_s, std::int16_t days_since_full) {
  if (record_utc_s == 0) return 0;
  return local_day_number(local_minute_of(record_utc_s)) - days_since_full;
}

class FullCharge {
 public:
  /// Devices stop slightly below their own 100 %.
  static constexpr std::int32_t kFullE4 = 9'950;

  /// 0 = never.
  explicit constexpr FullCharge(std::int32_t every_days) : every_days_(every_days) {}

  /// `last_full_day`: result of `last_full_day_of`.
  constexpr void restore(std::int32_t last_full_day) { last_full_day_ = last_full_day; }

  /// Called once per cycle in which the battery was read. An unknown or future day restarts the
  /// count from now.
  constexpr void update(std::int32_t local_day, std::int32_t soc_e4) {
    const bool is_unknown = last_full_day_ == 0 || last_full_day_ > local_day;
    if (is_unknown || soc_e4 >= kFullE4) last_full_day_ = local_day;
    const std::int32_t days = local_day - last_full_day_;
    days_since_full_ = static_cast<std::int16_t>(days < INT16_MAX ? days : INT16_MAX);
  }

  [[nodiscard]] constexpr std::int16_t days_since_full() const { return days_since_full_; }

  [[nodiscard]] constexpr FullChargeRequest request(std::int32_t price_centi_eur_per_mwh,
                                                    const PriceLevel& level) const {
    if (every_days_ == 0 || days_since_full_ < every_days_) return FullChargeRequest::kNone;
    const bool is_overdue = days_since_full_ > every_days_;
    const bool is_dear = level.is_known() && price_centi_eur_per_mwh > level.centi_eur_per_mwh();
    return is_dear && !is_overdue ? FullChargeRequest::kNoDischarge : FullChargeRequest::kCharge;
  }

 private:
  std::int32_t every_days_;
  std::int32_t last_full_day_ = 0;
  std::int16_t days_since_full_ = 0;
};

}  // namespace bess
