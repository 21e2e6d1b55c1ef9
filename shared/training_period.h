// Regimes of the Belgian imbalance price, training days of a student, and their age. For
// information: no decision depends on them.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "shared/fixed_text.h"
#include "shared/utc_text.h"

namespace bess {

// Formulas of the Belgian imbalance price by date: a policy trained in one regime does not transfer
// to another. Margins halved from 2024 to 2025.

struct PriceRegime {
  std::int64_t from_utc_s;  ///< local midnight
  const char* from_date;    ///< local, "2024-05-22"; empty for the first
  const char* change;       ///< label in a plot
  const char* name;         ///< "from 26 November 2024 (PICASSO)"
};

/// Ascending; every instant belongs to one.
inline constexpr PriceRegime kPriceRegimes[] = {
    // Regime of the paper: Elia's tariff until the local go-live of mFRR.
    {std::numeric_limits<std::int64_t>::min(), "", "", "until 21 May 2024 (marginal price)"},
    // Elia open data: ods046 and ods047 end, ods133 and ods134 begin; dead band of 25 MW, floor
    // under MIP; in 2024 every tenth quarter-hour settled below -200.
    {1'716'328'800, "2024-05-22", "dead band, floor",
     "from 22 May 2024 (dead band and floor, local mFRR)"},
    // Belgium joins PICASSO (aFRR; source: trade press); settled prices below -200 fall to one in a
    // hundred.
    {1'732'575'600, "2024-11-26", "PICASSO", "from 26 November 2024 (PICASSO)"},
    // The European day-ahead auction sells quarter-hours; before, hours.
    {1'759'269'600, "2025-10-01", "day-ahead in quarter-hours",
     "from 1 October 2025 (day-ahead in quarter-hours)"},
};

/// Training days older than this are reported.
inline constexpr int kTrainingAgeDaysMax = 180;

/// Local dates, "2023-01-01", inclusive; empty: unknown.
struct TrainingPeriod {
  std::string_view first_day, last_day;

  [[nodiscard]] constexpr bool is_known() const { return !last_day.empty(); }
  /// Unknown, or two ordered dates.
  [[nodiscard]] constexpr bool is_sound() const {
    std::string_view first = first_day, last = last_day;
    CivilTime t{};
    if (first.empty() && last.empty()) return true;
    return detail::take_date(first, t) && first.empty() && detail::take_date(last, t) &&
           last.empty() && first_day <= last_day;
  }
};

/// "2023-01-01 to 2023-05-22", or "on unknown days".
FixedText<24> training_days_text(const TrainingPeriod& trained);

/// "1285 days ago, before the price regime from 1 October 2025 (...)" if the newest training day is
/// old or in another price regime than `today`, a local date; else empty.
FixedText<127> training_age_text(const TrainingPeriod& trained, std::string_view today);

/// The local date of an instant. The time zone must be set.
FixedText<10> local_date_text(std::int64_t utc_s);

}  // namespace bess
