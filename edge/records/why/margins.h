// Decision margins in price and SoC. Student and price thresholds are monotone in both, which is
// proved over the whole lattice. Binary search finds the two change points of each axis exactly, in
// at most 38 evaluations.
#pragma once

#include <cstdint>

#include "shared/action.h"
#include "shared/features.h"
#include "shared/price_thresholds.h"

namespace bess {

/// Action of the student, or of a test double, at a point of the lattice.
using Policy = Action (*)(const LatticeState&);

/// Along one axis of the lattice, by index or price: charge up to `charge_last`, discharge from
/// `discharge_first`, idle between. One below or above the axis means never.
struct ChangePoints {
  int charge_last;
  int discharge_first;
  friend constexpr bool operator==(const ChangePoints&, const ChangePoints&) = default;
};

/// Requires: `action_at` never rises from `first` to `last` (property 3).
template <typename ActionAt>
constexpr ChangePoints find_change_points(int first, int last, const ActionAt& action_at) {
  const auto first_below = [&](int from, Action least) {
    int below = from;
    int above = last + 1;  // first known to be below `least`, or the end
    while (below < above) {
      const int middle = below + (above - below) / 2;
      if (action_at(middle) < least) {
        above = middle;
      } else {
        below = middle + 1;
      }
    }
    return below;
  };
  const int charge_end = first_below(first, Action::kCharge);
  return {.charge_last = charge_end - 1, .discharge_first = first_below(charge_end, Action::kIdle)};
}

/// Margins of one decision with all other inputs constant. The limits belong to the action.
struct Margins {
  std::int32_t charge_up_to_centi = 0;  ///< EUR/MWh / 100; at least the low threshold
  std::int32_t discharge_from_centi = 0;
  bool charges_at_some_soc = false;  ///< at this price
  bool discharges_at_some_soc = false;
  std::int32_t charge_up_to_soc_e4 = 0;
  std::int32_t discharge_from_soc_e4 = 0;
};

/// Margins of student and price thresholds, without the operator's rules and the limits of battery
/// and site.
Margins find_margins(const LatticeState& state, std::int32_t price_centi_eur_per_mwh,
                     const PriceThresholds& thresholds, Policy policy);

}  // namespace bess
