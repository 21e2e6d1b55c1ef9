#include "workstation/market/model/simulated_day_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/local_time.h"
#include "workstation/base/random.h"
#include "workstation/market/model/price_rounding.h"

namespace bess {
namespace {

/// What the auction foresees: the hours at hand and the day around them, on both sides.
constexpr std::size_t kNearHours = 3, kDayHours = 12;
constexpr double kNearForeseen = 0.12, kDayForeseen = 0.26;  ///< a, b
constexpr double kNoiseDeviation = 31;                       ///< EUR/MWh
constexpr double kNoiseShareOfDays = 0.6;  ///< of the noise's variance that lasts for days
constexpr double kDaysCorrelation = 0.992, kHoursCorrelation = 0.86;  ///< from hour to hour
/// Mean of Belgium's day-ahead prices by local hour, May 2024 to June 2025, less their mean of 82.
constexpr std::array<double, 24> kProfile{9,   4,   -2,  -7,  -9,  -9,  -3, 9,  18, 12, -3, -17,
                                          -28, -36, -42, -40, -30, -13, 9,  29, 42, 40, 28, 17};
constexpr double kMean = 112;         ///< below the settled prices', as in Belgium
constexpr double kSettledMean = 118;  ///< of the simulated market, about

double mean_around(const std::vector<double>& hours, std::size_t h, std::size_t reach) {
  const std::size_t first = h < reach ? 0 : h - reach;
  const std::size_t end = std::min(hours.size(), h + reach + 1);
  double sum = 0;
  for (std::size_t k = first; k < end; ++k) sum += hours[k];
  return sum / static_cast<double>(end - first);
}

}  // namespace

DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed) {
  std::vector<double> hours;
  for (std::size_t q = 0; q + 4 <= quarter_hours.size(); q += 4) {
    double sum = 0;
    for (std::size_t k = q; k < q + 4; ++k) sum += quarter_hours[k].price_eur_per_mwh;
    hours.push_back(sum / 4);
  }
  Random random(seed);
  double days = random.normal(), within = random.normal();
  DayAheadSeries series;
  for (std::size_t h = 0; h < hours.size(); ++h) {
    days = kDaysCorrelation * days +
           std::sqrt(1 - kDaysCorrelation * kDaysCorrelation) * random.normal();
    within = kHoursCorrelation * within +
             std::sqrt(1 - kHoursCorrelation * kHoursCorrelation) * random.normal();
    const double noise =
        std::sqrt(kNoiseShareOfDays) * days + std::sqrt(1 - kNoiseShareOfDays) * within;
    const std::int64_t utc_s = quarter_hours[4 * h].utc_s;
    const auto hour = static_cast<std::size_t>(local_minute_of(utc_s).minute_of_day / 60);
    const double foreseen = kNearForeseen * (mean_around(hours, h, kNearHours) - kSettledMean) +
                            kDayForeseen * (mean_around(hours, h, kDayHours) - kSettledMean);
    const double price = in_cents(kMean + kProfile[hour] + foreseen + kNoiseDeviation * noise);
    for (int q = 0; q < 4; ++q) {
      append_day_ahead(series, {utc_s + q * kSecondsPerQuarterHour, price, 60, 0});
    }
  }
  return series;
}

}  // namespace bess
