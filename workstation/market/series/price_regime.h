// How the Belgian imbalance price came about, by date: a policy that learnt one way knows little of
// another. Margins halved from 2024 to 2025.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bess {

/// The end is excluded.
struct UtcSpan {
  std::int64_t from_s, until_s;
};

struct PriceRegime {
  std::int64_t from_utc_s;  ///< local midnight
  const char* from_date;    ///< local, "2024-05-22"; empty of the first
  const char* change;       ///< what changed with it, for a mark in a picture
  const char* name;         ///< "from 26 November 2024 (PICASSO)"
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
