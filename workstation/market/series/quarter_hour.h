// One settled quarter-hour of the imbalance market: what the TSO publishes after it ended, what the
// simulator draws, and what the minute path is built on.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "shared/units_and_limits.h"

namespace bess {

inline constexpr double kNotPublished = std::numeric_limits<double>::quiet_NaN();

inline bool is_published(double value) { return !std::isnan(value); }

struct QuarterHour {
  std::int64_t utc_s = 0;                      ///< start of the interval
  double price_eur_per_mwh = kNotPublished;    ///< settled, the same for both directions
  double system_imbalance_mw = kNotPublished;  ///< mean over the quarter-hour, negative = short
  double alpha_eur_per_mwh = kNotPublished;
  double marginal_incremental_eur_per_mwh = kNotPublished;
  double marginal_decremental_eur_per_mwh = kNotPublished;
};

}  // namespace bess
