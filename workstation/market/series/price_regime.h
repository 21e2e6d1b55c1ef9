// Which of the price regimes (shared/price_regime.h) prices lie in.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/price_regime.h"

namespace bess {

/// The end is excluded.
struct UtcSpan {
  std::int64_t from_s, until_s;
};

/// Ascending; every moment belongs to one.
std::span<const PriceRegime> price_regimes();

/// Those that the span meets, in order.
std::vector<const PriceRegime*> regimes_met(const UtcSpan& span);

/// Names of the regimes that `traded` meets and `learnt` does not, or empty.
std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded);

/// Names, a comma between.
std::string regime_names(const std::vector<const PriceRegime*>& regimes);

}  // namespace bess
