#include "workstation/market/series/price_regime.h"

#include <algorithm>
#include <iterator>

namespace bess {

std::span<const PriceRegime> price_regimes() { return kPriceRegimes; }

std::vector<const PriceRegime*> regimes_met(const UtcSpan& span) {
  std::vector<const PriceRegime*> met;
  for (const PriceRegime* regime = std::begin(kPriceRegimes); regime != std::end(kPriceRegimes);
       ++regime) {
    const PriceRegime* const next = regime + 1;
    const bool begins_before = next == std::end(kPriceRegimes) || span.from_s < next->from_utc_s;
    if (span.until_s > regime->from_utc_s && begins_before) met.push_back(regime);
  }
  return met;
}

std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded) {
  const std::vector<const PriceRegime*> known = regimes_met(learnt);
  std::vector<const PriceRegime*> unknown = regimes_met(traded);
  std::erase_if(unknown,
                [&](const PriceRegime* r) { return std::ranges::find(known, r) != known.end(); });
  return regime_names(unknown);
}

std::string regime_names(const std::vector<const PriceRegime*>& regimes) {
  std::string names;
  for (const PriceRegime* regime : regimes) {
    names.append(names.empty() ? "" : ", ").append(regime->name);
  }
  return names;
}

}  // namespace bess
