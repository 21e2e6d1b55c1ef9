#include "workstation/market/model/market_scores.h"

#include <cmath>
#include <numbers>

#include "shared/local_time.h"

namespace bess {
namespace {

constexpr std::int64_t kSecondsPerDay = 86'400;

double profile_at(const HourlyProfile& profile, double hour) {
  const double position = hour - 0.5 < 0 ? hour + 23.5 : hour - 0.5;
  const auto before = static_cast<std::size_t>(position);
  const double weight = position - static_cast<double>(before);
  return (1 - weight) * profile[before % 24] + weight * profile[(before + 1) % 24];
}

double expected_score(const ScoreParameters& parameters, const MarketCalendar& calendar) {
  const bool midday = calendar.hour >= 11 && calendar.hour < 15;
  return profile_at(parameters.profile, calendar.hour) + parameters.winter * calendar.winter +
         (midday ? parameters.midday * (1 - calendar.winter) / 2 : 0) +
         (calendar.weekend ? parameters.weekend : 0);
}

}  // namespace

MarketCalendar market_calendar_of(std::int64_t utc_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const std::int64_t day =
      utc_from_civil({local.year, local.month, local.day, 0, 0, 0}) / kSecondsPerDay;
  const std::int64_t new_year = utc_from_civil({local.year, 1, 1, 0, 0, 0}) / kSecondsPerDay;
  const double day_of_year = static_cast<double>(day - new_year) + 1;
  const std::int64_t weekday =
      ((day + 3) % 7 + 7) % 7;  // 1 January 1970 was a Thursday; Monday = 0
  return {.hour = local.minute_of_day / 60.0,
          .winter = std::cos(2 * std::numbers::pi * (day_of_year - 15) / 365),
          .weekend = weekday >= 5};
}

ScoreProcess::ScoreProcess(const ScoreParameters& parameters)
    : parameters_(parameters),
      parts_{UnitAutoregression(parameters.autoregressions[0].correlation),
             UnitAutoregression(parameters.autoregressions[1].correlation),
             UnitAutoregression(parameters.autoregressions[2].correlation)} {}

double ScoreProcess::next(const MarketCalendar& calendar, Random& random) {
  double noise = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    noise += std::sqrt(parameters_.autoregressions[i].share) * parts_[i].next(random);
  }
  return expected_score(parameters_, calendar) + parameters_.deviation * noise;
}

}  // namespace bess
