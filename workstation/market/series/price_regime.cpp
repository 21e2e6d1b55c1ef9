#include "workstation/market/series/price_regime.h"

#include <iterator>
#include <limits>

namespace bess {
namespace {

struct Regime {
  std::int64_t from_utc_s;  ///< local midnight
  const char* name;
};

constexpr Regime kRegimes[] = {
    {std::numeric_limits<std::int64_t>::min(), "until 21 May 2024 (marginal price)"},
    {1'716'328'800, "from 22 May 2024 (dead band and floor, local mFRR)"},
    {1'732'575'600, "from 26 November 2024 (PICASSO)"},
    {1'759'269'600, "from 1 October 2025 (day-ahead in quarter-hours)"},
};
constexpr std::size_t kRegimeCount = std::size(kRegimes);

bool meets(const UtcSpan& span, std::size_t regime) {
  return span.until_s > kRegimes[regime].from_utc_s &&
         (regime + 1 == kRegimeCount || span.from_s < kRegimes[regime + 1].from_utc_s);
}

}  // namespace

std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded) {
  std::string names;
  for (std::size_t r = 0; r < kRegimeCount; ++r) {
    if (!meets(traded, r) || meets(learnt, r)) continue;
    names.append(names.empty() ? "" : ", ").append(kRegimes[r].name);
  }
  return names;
}

}  // namespace bess
