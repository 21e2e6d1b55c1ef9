#include "edge/records/why/margins.h"

#include <algorithm>

namespace bess {
namespace {

// The ends of the lattice also cover all values beyond them, up to the thresholds. Lattice prices
// are rounded, halves up: 84 is 83.50 to 84.49.
constexpr std::int32_t kCentiBelow = kCentiPerEur / 2;
constexpr std::int32_t kCentiAbove = kCentiPerEur - kCentiBelow - 1;
constexpr std::int32_t kSocBelow = kSocE4PerLatticeStep / 2;
constexpr std::int32_t kSocAbove = kSocE4PerLatticeStep - kSocBelow - 1;

void find_price_margins(const LatticeState& state, const PriceThresholds& thresholds, Policy policy,
                        Margins& margins) {
  const std::int32_t low_centi = thresholds.low_eur_per_mwh * kCentiPerEur;
  const std::int32_t high_centi = thresholds.high_eur_per_mwh * kCentiPerEur;
  const auto action_at = [&](int price) {
    LatticeState at = state;
    at.price_eur_per_mwh = static_cast<std::int16_t>(price);
    return policy(at);
  };
  const ChangePoints found =
      find_change_points(kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh, action_at);
  const bool always_charges = found.charge_last == kLatticePriceMaxEurPerMwh;
  const bool always_discharges = found.discharge_first == kLatticePriceMinEurPerMwh;
  const bool never_charges = found.charge_last < kLatticePriceMinEurPerMwh;
  const bool never_discharges = found.discharge_first > kLatticePriceMaxEurPerMwh;
  const std::int32_t charge_centi = never_charges ? low_centi
                                    : always_charges
                                        ? high_centi - 1
                                        : found.charge_last * kCentiPerEur + kCentiAbove;
  const std::int32_t discharge_centi = never_discharges ? high_centi
                                       : always_discharges
                                           ? low_centi + 1
                                           : found.discharge_first * kCentiPerEur - kCentiBelow;
  margins.charge_up_to_centi = std::clamp(charge_centi, low_centi, high_centi - 1);
  margins.discharge_from_centi = std::clamp(discharge_centi, low_centi + 1, high_centi);
}

void find_soc_margins(const LatticeState& state, std::int32_t price_centi,
                      const PriceThresholds& thresholds, Policy policy, Margins& margins) {
  const Action of_price = thresholds.action_beyond(price_centi);
  const auto action_at = [&](int soc_index) {
    if (of_price != Action::kIdle) return of_price;
    LatticeState at = state;
    at.soc_index = static_cast<std::int16_t>(soc_index);
    return policy(at);
  };
  const ChangePoints found = find_change_points(0, kSocCount - 1, action_at);
  margins.charges_at_some_soc = found.charge_last >= 0;
  margins.discharges_at_some_soc = found.discharge_first < kSocCount;
  margins.charge_up_to_soc_e4 =
      std::clamp(found.charge_last * kSocE4PerLatticeStep + kSocAbove, 0, kSocFullE4);
  margins.discharge_from_soc_e4 =
      std::clamp(found.discharge_first * kSocE4PerLatticeStep - kSocBelow, 0, kSocFullE4);
}

}  // namespace

Margins find_margins(const LatticeState& state, std::int32_t price_centi_eur_per_mwh,
                     const PriceThresholds& thresholds, Policy policy) {
  Margins margins;
  find_price_margins(state, thresholds, policy, margins);
  find_soc_margins(state, price_centi_eur_per_mwh, thresholds, policy, margins);
  return margins;
}

}  // namespace bess
