// Trailing price level [SPEC 8]: exponentially weighted mean of the prices used for decisions, time
// constant one day. In integers, so that it is bit-identical on workstation, simulator and edge.
//
// Each row counts once, at the first decision that uses it. Gaps do not change the level.
#pragma once

#include <cstdint>

#include "shared/fixed_point.h"
#include "shared/units_and_limits.h"

namespace bess {

struct PriceLevel {
  /// Weight of a decision is 1 / kDecisions: one day of decisions.
  static constexpr std::int64_t kDecisions = kStepsPerDay;
  static constexpr int kFractionBits = 16;
  static constexpr std::int64_t kQ16PerEur = std::int64_t{kCentiPerEur} << kFractionBits;
  static constexpr std::int32_t kMinCenti = kLatticePriceMinEurPerMwh * kCentiPerEur;
  static constexpr std::int32_t kMaxCenti = kLatticePriceMaxEurPerMwh * kCentiPerEur;

  std::int64_t centi_q16 = 0;         ///< hundredths of EUR/MWh, times 2^16
  std::int64_t row_minute_utc_s = 0;  ///< of the newest row used; 0: none, the level is unknown

  /// Level as if all earlier prices had this value.
  static constexpr PriceLevel starting_at(std::int32_t centi_eur_per_mwh) {
    return {.centi_q16 = to_q16(centi_eur_per_mwh), .row_minute_utc_s = 1};
  }

  [[nodiscard]] constexpr bool is_known() const { return row_minute_utc_s != 0; }
  /// False for values that no prices lead to, from damaged storage.
  [[nodiscard]] constexpr bool is_sound() const {
    return centi_q16 >= to_q16(kMinCenti) && centi_q16 <= to_q16(kMaxCenti) &&
           row_minute_utc_s >= 0;
  }

  /// Adds the newest row of a decision. The first one sets the level. Prices are clamped to the
  /// lattice, so that one spike does not dominate a day.
  constexpr void observe(std::int64_t minute_utc_s, std::int32_t price_centi_eur_per_mwh) {
    if (minute_utc_s <= row_minute_utc_s) return;
    const std::int64_t price_q16 = to_q16(price_centi_eur_per_mwh);
    centi_q16 =
        is_known() ? centi_q16 + rounding_divide(price_q16 - centi_q16, kDecisions) : price_q16;
    row_minute_utc_s = minute_utc_s;
  }

  [[nodiscard]] constexpr std::int32_t centi_eur_per_mwh() const {
    return static_cast<std::int32_t>(rounding_divide(centi_q16, std::int64_t{1} << kFractionBits));
  }
  friend constexpr bool operator==(const PriceLevel&, const PriceLevel&) = default;

 private:
  static constexpr std::int64_t to_q16(std::int32_t centi) {
    return std::int64_t{clamp_to(centi, kMinCenti, kMaxCenti)} << kFractionBits;
  }
};

}  // namespace bess
