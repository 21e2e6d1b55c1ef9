#include "workstation/market/series/price_regime.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace bess {
namespace {

constexpr PriceRegime kRegimes[] = {
    // The paper's: Elia's tariff of the balancing services until the local go-live of mFRR.
    {std::numeric_limits<std::int64_t>::min(), "", "", "until 21 May 2024 (marginal price)"},
    // Elia open data: ods046 and ods047 end, ods133 and ods134 begin; dead band of 25 MW, a floor
    // under MIP; of 2024 every tenth quarter-hour settled below -200.
    {1'716'328'800, "2024-05-22", "dead band, floor",
     "from 22 May 2024 (dead band and floor, local mFRR)"},
    // Belgium joins PICASSO (aFRR), as the trade press told of it; settled prices below -200 fall
    // to one in a hundred.
    {1'732'575'600, "2024-11-26", "PICASSO", "from 26 November 2024 (PICASSO)"},
    // The day-ahead auction of Europe sells quarter-hours; until then hours, repeated.
    {1'759'269'600, "2025-10-01", "day-ahead in quarter-hours",
     "from 1 October 2025 (day-ahead in quarter-hours)"},
};

}  // namespace

std::span<const PriceRegime> price_regimes() { return kRegimes; }

std::vector<const PriceRegime*> regimes_met(const UtcSpan& span) {
  std::vector<const PriceRegime*> met;
  for (const PriceRegime* regime = std::begin(kRegimes); regime != std::end(kRegimes); ++regime) {
    const PriceRegime* const next = regime + 1;
    const bool begins_before = next == std::end(kRegimes) || span.from_s < next->from_utc_s;
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
