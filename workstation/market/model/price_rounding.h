// Drawn prices are made in whole cents, as the settled ones of 2023 are published.
#pragma once

#include <cmath>

namespace bess {

inline double in_cents(double eur_per_mwh) {
  return std::round(100 * eur_per_mwh) / 100 + 0.0;  // + 0.0: no negative zero
}

}  // namespace bess
