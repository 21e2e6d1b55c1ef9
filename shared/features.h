// Feature computation: raw measurements to a lattice point [SPEC 6]. The same integer code runs in
// training, proof, simulator and edge.
//
//   minute of the quarter-hour  T_qh 0..14     quarter-hour of the local day  qh 0..95
//   context class               mo   1..12     state of charge                0..200  (0.5 %)
//   indicative price            -500..1500     (1 EUR/MWh, clamped; beyond: guard)
#pragma once

#include <cstdint>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

/// One point of the lattice. Invariant: every field is in the range above.
struct LatticeState {
  std::int16_t minute_of_quarter_hour;
  std::int16_t quarter_hour;
  std::int16_t context_class;
  std::int16_t soc_index;
  std::int16_t price_eur_per_mwh;
  friend constexpr bool operator==(const LatticeState&, const LatticeState&) = default;
};

/// Nearest lattice index of a SoC given in 1e-4 (0..10000), halves up; outside values are clamped.
std::int16_t soc_index_of(std::int32_t soc_e4);
/// Nearest whole EUR/MWh, halves up, clamped to the lattice.
std::int16_t lattice_price_of(std::int32_t price_centi_eur_per_mwh);

/// `context_class` 1..12, of the student's ContextClasses.
LatticeState make_lattice_state(const LocalMinute& now, std::int16_t context_class,
                                std::int32_t soc_e4, std::int32_t price_centi_eur_per_mwh);

}  // namespace bess
