#include "shared/features.h"

#include "shared/fixed_point.h"

namespace bess {

std::int16_t soc_index_of(std::int32_t soc_e4) {
  const std::int32_t clamped = clamp_to<std::int32_t>(soc_e4, 0, kSocFullE4);
  return static_cast<std::int16_t>(rounding_divide(clamped, kSocE4PerLatticeStep));
}

std::int16_t lattice_price_of(std::int32_t price_centi_eur_per_mwh) {
  const std::int32_t clamped =
      clamp_to<std::int32_t>(price_centi_eur_per_mwh, kLatticePriceMinEurPerMwh * kCentiPerEur,
                             kLatticePriceMaxEurPerMwh * kCentiPerEur);
  return static_cast<std::int16_t>(rounding_divide(clamped, kCentiPerEur));
}

LatticeState make_lattice_state(const LocalMinute& now, std::int16_t context_class,
                                std::int32_t soc_e4, std::int32_t price_centi_eur_per_mwh) {
  return {.minute_of_quarter_hour = static_cast<std::int16_t>(now.minute_of_quarter_hour),
          .quarter_hour = static_cast<std::int16_t>(now.quarter_hour),
          .context_class = context_class,
          .soc_index = soc_index_of(soc_e4),
          .price_eur_per_mwh = lattice_price_of(price_centi_eur_per_mwh)};
}

}  // namespace bess
