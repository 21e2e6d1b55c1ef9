// Prices of the last hours before program start, and the level that a controller running all the
// time would have now. Filled in any order: servers answer with the newest rows first.
#pragma once

#include <array>
#include <cstdint>

#include "shared/price_level.h"
#include "shared/units_and_limits.h"

namespace bess {

class PriceHistory {
 public:
  static constexpr int kHoursMax = 96;  ///< four time constants of the level

  /// Covers the rows used by decisions of the `hours` (1..kHoursMax) before now.
  PriceHistory(int hours, std::int64_t now_utc_s)
      : minutes_(60 * hours),
        first_minute_utc_s_(now_utc_s / kSecondsPerStep * kSecondsPerStep -
                            std::int64_t{60} * minutes_) {
    centi_.fill(kNoRow);
  }

  /// Rows outside the hours are ignored; the last row of a minute wins.
  void add(std::int64_t minute_utc_s, std::int32_t price_centi_eur_per_mwh) {
    const std::int64_t minute = (minute_utc_s - first_minute_utc_s_) / 60;
    if (minute_utc_s < first_minute_utc_s_ || minute >= minutes_) return;
    std::int32_t& centi = centi_[static_cast<std::size_t>(minute)];
    if (centi == kNoRow) ++rows_;
    centi = price_centi_eur_per_mwh;
    if (oldest_ > minute) oldest_ = static_cast<int>(minute);
  }

  [[nodiscard]] int rows() const { return rows_; }
  /// From the oldest row to now, rounded up to whole hours; 0 = no row.
  [[nodiscard]] int hours_covered() const {
    return rows_ == 0 ? 0 : (minutes_ - oldest_ + 59) / 60;
  }
  [[nodiscard]] std::int64_t first_minute_utc_s() const { return first_minute_utc_s_; }

  /// At each tick the newest row decides: that of the previous minute, or of the one before. An
  /// older row was used by the previous tick.
  [[nodiscard]] PriceLevel level() const {
    PriceLevel level;
    for (int minute = 0; minute < minutes_; minute += kMinutesPerStep) {
      if (!observe(minute + 1, level)) static_cast<void>(observe(minute, level));
    }
    return level;
  }

 private:
  static constexpr std::int32_t kNoRow = INT32_MIN;

  bool observe(int minute, PriceLevel& level) const {
    const std::int32_t centi = centi_[static_cast<std::size_t>(minute)];
    if (centi == kNoRow) return false;
    level.observe(first_minute_utc_s_ + std::int64_t{60} * minute, centi);
    return true;
  }

  int minutes_;
  std::int64_t first_minute_utc_s_;
  int rows_ = 0;
  int oldest_ = INT32_MAX;
  std::array<std::int32_t, std::size_t{60} * kHoursMax> centi_;
};

}  // namespace bess
