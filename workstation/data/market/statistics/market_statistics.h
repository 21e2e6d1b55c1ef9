// Market statistics and their report, to compare the simulated market with the real one and to
// check downloads.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/units_and_limits.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/data/market/series/plausibility.h"

namespace bess {

inline constexpr std::array<int, 4> kAutocorrelationLags{1, 2, 4, 96};  ///< quarter-hours

struct PriceStatistics {
  std::size_t count = 0;  ///< settled quarter-hours
  double mean = 0, minimum = 0, quartile_1 = 0, median = 0, quartile_3 = 0, maximum = 0;
  double share_below_minus_200 = 0, share_below_0 = 0, share_above_1000 = 0;
  std::array<double, kAutocorrelationLags.size()> autocorrelation{};  ///< by kAutocorrelationLags
  double sign_flip_rate = 0;  ///< share of neighbours with different signs
};

/// Difference between the indicative price of one minute of the quarter-hour and the settled price.
struct Convergence {
  std::size_t count = 0;
  double median_error = 0, mean_error = 0;  ///< absolute, EUR/MWh
};
using ConvergenceByMinute = std::array<Convergence, kMinutesPerQuarterHour>;

/// Local day of 23 or 25 hours that the file covers from midnight to midnight.
struct ClockChange {
  LocalDate day;
  int quarter_hours;  ///< 92 or 100
};

/// Settled prices of one regime.
struct RegimeStatistics {
  const PriceRegime* regime;
  PriceStatistics price;
};

struct MarketStatistics {
  std::int64_t from_utc_s = 0, until_utc_s = 0;  ///< exclusive
  PriceStatistics price;
  std::optional<double> imbalance_sign_flip_rate;  ///< quarter-hour files only
  std::optional<ConvergenceByMinute> convergence;  ///< minute files only
  std::vector<Gap> settled_gaps;                   ///< no settled price
  std::vector<Gap> indicative_gaps;                ///< no indicative price (minute files only)
  std::vector<ClockChange> clock_changes;
  std::vector<RegimeStatistics> regimes;  ///< regimes of the file, in order
};

/// Settled price of each quarter-hour of the grid, NaN if unknown. `settled[q]`.
PriceStatistics price_statistics(std::span<const double> settled);
/// Settled price per quarter-hour of the UTC grid of the series.
std::vector<double> settled_by_quarter_hour(const MinuteSeries& series);
ConvergenceByMinute convergence_by_minute(const MinuteSeries& series);
/// Share of neighbouring quarter-hours with imbalances of different signs.
double imbalance_sign_flip_rate(const std::vector<QuarterHour>& quarter_hours);

MarketStatistics statistics_of_minutes(const MinuteSeries& series);
/// `quarter_hours` ascending, not empty.
MarketStatistics statistics_of_quarter_hours(const std::vector<QuarterHour>& quarter_hours);

/// Linear interpolation between order statistics (the usual "type 7"). `sorted` ascending, not
/// empty.
double quantile_of_sorted(std::span<const double> sorted, double probability);

// Market statistics as text and JSON.

/// `what`: name of the price.
std::string format_statistics_text(const MarketStatistics& statistics,
                                   std::string_view what = "settled price");
/// One JSON object on one line.
std::string format_statistics_json(const MarketStatistics& statistics);

}  // namespace bess
