// How the Belgian imbalance price came about, by date: a policy that learnt one way knows little of
// another. Margins halved from 2024 to 2025.
#pragma once

#include <cstdint>
#include <limits>

namespace bess {

struct PriceRegime {
  std::int64_t from_utc_s;  ///< local midnight
  const char* from_date;    ///< local, "2024-05-22"; empty of the first
  const char* change;       ///< what changed with it, for a mark in a picture
  const char* name;         ///< "from 26 November 2024 (PICASSO)"
};

/// Ascending; every moment belongs to one.
inline constexpr PriceRegime kPriceRegimes[] = {
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

}  // namespace bess
