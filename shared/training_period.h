// The days whose prices a student was trained on, and whether they are too long ago: nothing of it
// decides.
#pragma once

#include <string_view>

#include "shared/fixed_text.h"
#include "shared/utc_text.h"

namespace bess {

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
