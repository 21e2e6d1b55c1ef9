// One row alone does not move the battery: a price that lies further from the one before than
// 2300 EUR/MWh is held until the next row tells whether it was real. Pure integers.
#pragma once

#include <cstdint>

#include "edge/prices/price_row.h"

namespace bess {

class StepHold {
 public:
  static constexpr std::int32_t kStepCentiEurPerMwh = 230'000;

  struct Verdict {
    bool is_taken = false;
    bool is_large_step = false;  ///< further from the price before than that
  };

  /// Of a row that is not older than `before`, the newest one taken so far. What is held is
  /// confirmed by a later row within the step of it, and given up for a row within the step of
  /// `before`; a row far from both is held in its place. A row older than what is held is a stale
  /// cache's.
  constexpr Verdict judge(const PriceRow& before, const PriceRow& row) {
    if (has_held_ && row.minute_utc_s < held_.minute_utc_s) return {};
    if (!is_large(before, row)) return take(false);
    const bool is_confirmed =
        has_held_ && row.minute_utc_s > held_.minute_utc_s && !is_large(held_, row);
    if (is_confirmed) return take(true);
    held_ = row;
    has_held_ = true;
    return {};
  }

  [[nodiscard]] constexpr bool has_held() const { return has_held_; }
  /// Only while something is held.
  [[nodiscard]] constexpr const PriceRow& held() const { return held_; }

 private:
  [[nodiscard]] static constexpr bool is_large(const PriceRow& from, const PriceRow& to) {
    const std::int32_t step = to.price_centi_eur_per_mwh - from.price_centi_eur_per_mwh;
    return (step < 0 ? -step : step) > kStepCentiEurPerMwh;
  }
  constexpr Verdict take(bool is_large_step) {
    has_held_ = false;
    return {.is_taken = true, .is_large_step = is_large_step};
  }

  bool has_held_ = false;
  PriceRow held_;
};

}  // namespace bess
