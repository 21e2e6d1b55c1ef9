#include "shared/training_period.h"

#include <cstdio>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

std::int64_t day_number(std::string_view date) {
  CivilTime t{};
  detail::take_date(date, t);
  return utc_from_civil(t) / kSecondsPerDay;
}

}  // namespace

FixedText<24> training_days_text(const TrainingPeriod& trained) {
  if (!trained.is_known()) return "on unknown days";
  char text[25];
  std::snprintf(text, sizeof text, "%.10s to %.10s", trained.first_day.data(),
                trained.last_day.data());
  return text;
}

FixedText<127> training_age_text(const TrainingPeriod& trained, std::string_view today) {
  if (!trained.is_known() || !trained.is_sound() || today <= trained.last_day) return {};
  const auto days = static_cast<int>(day_number(today) - day_number(trained.last_day));
  const PriceRegime* later = nullptr;
  for (const PriceRegime& regime : kPriceRegimes) {
    if (trained.last_day < regime.from_date && regime.from_date <= today) later = &regime;
  }
  if (days <= kTrainingAgeDaysMax && later == nullptr) return {};
  char text[128];
  std::snprintf(text, sizeof text, "%d days ago%s%s", days,
                later == nullptr ? "" : ", before the price regime ",
                later == nullptr ? "" : later->name);
  return text;
}

FixedText<10> local_date_text(std::int64_t utc_s) { return local_text(utc_s).view(); }

}  // namespace bess
