// Local days of the market in command-line form, and the quarter-hour of the imbalance market.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "shared/units_and_limits.h"

namespace bess {

struct LocalDate {
  int year, month, day;
  friend constexpr auto operator<=>(const LocalDate&, const LocalDate&) = default;
};

/// Parses YYYY-MM-DD; `what` names the option in the UserError.
LocalDate parse_local_date(std::string_view text, std::string_view what);
std::string format_local_date(const LocalDate& date);
LocalDate add_days(const LocalDate& date, int days);
LocalDate local_date_of(std::int64_t utc_s);

/// UTC instant at which the local day begins. Needs the market's time zone.
std::int64_t local_midnight_utc_s(const LocalDate& date);

// Settled quarter-hour of the imbalance market: published by the TSO after its end, or simulated;
// input of the minute path.

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
