// Price thresholds, which take precedence over every policy [SPEC 5, 7]: charge at or below the low
// one, discharge at or above the high one. Set by the BRP; the student is corrected and proved with
// them, and the edge's guard enforces its own.
//
// A threshold inside the lattice binds the student for all prices beyond it, because prices outside
// the lattice are clamped. Outside the lattice only the guard applies it, which certificates state
// [SPEC 6].
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/action.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Largest absolute value of thresholds and bounds of rules, EUR/MWh.
inline constexpr std::int32_t kThresholdMaxEurPerMwh = kUnusualPriceMaxEurPerMwh;

struct PriceThresholds {
  std::int32_t low_eur_per_mwh = kLatticePriceMinEurPerMwh;   ///< property 1: charge at or below
  std::int32_t high_eur_per_mwh = kLatticePriceMaxEurPerMwh;  ///< property 2: discharge at or above

  /// False: contradicting thresholds.
  [[nodiscard]] constexpr bool are_ordered() const { return low_eur_per_mwh < high_eur_per_mwh; }
  [[nodiscard]] constexpr bool low_binds_student() const {
    return low_eur_per_mwh >= kLatticePriceMinEurPerMwh;
  }
  [[nodiscard]] constexpr bool high_binds_student() const {
    return high_eur_per_mwh <= kLatticePriceMaxEurPerMwh;
  }
  /// kIdle between them, where the student decides.
  [[nodiscard]] constexpr Action action_beyond(std::int32_t price_centi_eur_per_mwh) const {
    if (price_centi_eur_per_mwh <= low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
    if (price_centi_eur_per_mwh >= high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
    return Action::kIdle;
  }
  friend constexpr bool operator==(const PriceThresholds&, const PriceThresholds&) = default;
};

/// Note after a threshold that is shown with a proof.
constexpr std::string_view guard_alone_note(bool binds_student) {
  return binds_student ? "" : " (guard only)";
}

}  // namespace bess
