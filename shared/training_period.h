// Regimes of the Belgian imbalance price, the days whose prices a student was trained on, and
// whether they are too long ago: no decision depends on it.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "shared/fixed_text.h"
#include "shared/utc_text.h"

namespace bess {

// How the Belgian imbalance price came about, by date: a policy that learnt one way knows little of
// another. Margins halved from 2024 to 2025.

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

/// Training days older than this are reported.
inline constexpr int kTrainingAgeDaysMax = 180;

/// Local dates, "2023-01-01", the last included; empty: not known.
struct TrainingPeriod {
  std::string_view first_day, last_day;

  [[nodiscard]] constexpr bool is_known() const { return !last_day.empty(); }
  /// Not known, or two days in order.
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

/// "1285 days ago, before the price regime from 1 October 2025 (...)" of a newest training day that
/// is old, or lies in another price regime than today; else empty, also before that day. `today`:
/// a local date.
FixedText<127> training_age_text(const TrainingPeriod& trained, std::string_view today);

/// The local date of an instant. The time zone must be set.
FixedText<10> local_date_text(std::int64_t utc_s);

}  // namespace bess
