// The two prices at which a rule stands above every policy [SPEC 5, 7]: charge at or below the low
// one, discharge at or above the high one. The BRP sets them; the student is corrected and proved
// against them, the edge's guard enforces its own whatever the student says.
//
// Only a threshold inside the lattice binds the student: on all lattice prices beyond it, and so on
// every price there is, because prices outside the lattice are clamped to its ends. One outside the
// lattice is the guard's alone, and whoever shows a certificate says so [SPEC 6].
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/action.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Thresholds and the ends of rules lie within +- this many EUR/MWh: further out nobody has one,
/// and a price beyond is beyond each of them.
inline constexpr std::int32_t kThresholdMaxEurPerMwh = kUnusualPriceMaxEurPerMwh;

struct PriceThresholds {
  std::int32_t low_eur_per_mwh = kLatticePriceMinEurPerMwh;   ///< property 1: charge at or below
  std::int32_t high_eur_per_mwh = kLatticePriceMaxEurPerMwh;  ///< property 2: discharge at or above

  /// False: no price could be held against both.
  [[nodiscard]] constexpr bool are_ordered() const { return low_eur_per_mwh < high_eur_per_mwh; }
  [[nodiscard]] constexpr bool low_binds_student() const {
    return low_eur_per_mwh >= kLatticePriceMinEurPerMwh;
  }
  [[nodiscard]] constexpr bool high_binds_student() const {
    return high_eur_per_mwh <= kLatticePriceMaxEurPerMwh;
  }
  /// kIdle between them, where the student is asked.
  [[nodiscard]] constexpr Action action_beyond(std::int32_t price_centi_eur_per_mwh) const {
    if (price_centi_eur_per_mwh <= low_eur_per_mwh * kCentiPerEur) return Action::kCharge;
    if (price_centi_eur_per_mwh >= high_eur_per_mwh * kCentiPerEur) return Action::kDischarge;
    return Action::kIdle;
  }
  friend constexpr bool operator==(const PriceThresholds&, const PriceThresholds&) = default;
};

/// Stands behind a threshold wherever it is shown beside a proof.
constexpr std::string_view guard_alone_note(bool binds_student) {
  return binds_student ? "" : " (the guard's alone)";
}

}  // namespace bess
