// Where a decision would change: the student and the price thresholds are monotone in price and in
// SoC, which is proved over the whole lattice, so that along either axis there is one price up to
// which it charges and one from which it discharges. Binary search finds both exactly, in 38
// evaluations at most.
#pragma once

#include <cstdint>

#include "shared/action.h"
#include "shared/features.h"
#include "shared/price_thresholds.h"
#include "shared/units_and_limits.h"

namespace bess {

/// What the student, or one of the tests in its place, does at a point of the lattice.
using Policy = Action (*)(const LatticeState&);

/// Along one axis of the lattice, by its index or price. Charge holds up to `charge_last`,
/// discharge from `discharge_first` on, idle between; one below the axis or one above it: never.
struct ChangePoints {
  int charge_last;
  int discharge_first;
  friend constexpr bool operator==(const ChangePoints&, const ChangePoints&) = default;
};

/// Requires: `action_at` never rises from `first` to `last`, as property 3 has it.
template <typename ActionAt>
constexpr ChangePoints find_change_points(int first, int last, const ActionAt& action_at) {
  const auto first_below = [&](int from, Action least) {
    int below = from;
    int above = last + 1;  // the first that is known to lie below `least`, or the end
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

/// Of one decision, everything else staying as it is; in the units of the edge, the ends belonging
/// to the action.
struct Margins {
  std::int32_t charge_up_to_centi = 0;  ///< EUR/MWh / 100; the threshold at the least
  std::int32_t discharge_from_centi = 0;
  bool charges_at_some_soc = false;  ///< at this price
  bool discharges_at_some_soc = false;
  std::int32_t charge_up_to_soc_e4 = 0;
  std::int32_t discharge_from_soc_e4 = 0;
};

/// Of the student with the guard's thresholds around it, at a price in hundredths of EUR/MWh. Rules
/// of the operator and what the battery and its site allow are not in it.
Margins find_margins(const LatticeState& state, std::int32_t price_centi_eur_per_mwh,
                     const PriceThresholds& thresholds, Policy policy);

}  // namespace bess
