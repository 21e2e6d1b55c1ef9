// A simulated imbalance market of Belgium's 2023 kind: quarter-hours with system imbalance,
// marginal prices and the settled price by the exact formula, in whole cents, from
// market_parameters.h; and how far its figures are from those of the real market.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/host/minute_file.h"
#include "workstation/data/market/model/market_parameters.h"
#include "workstation/data/market/model/minute_path.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

// The random drivers of the simulated market: three scores a quarter-hour, whose ranks pick the
// rungs of the ladders. A score is an expectation from the calendar plus autoregressive noise.

/// What the calendar says about a quarter-hour, in the market's local time.
struct MarketCalendar {
  double hour;    ///< 0..24
  double winter;  ///< 1 in mid January, -1 in mid July
  bool weekend;
};

/// Needs the market's time zone (set_market_time_zone).
MarketCalendar market_calendar_of(std::int64_t utc_s);

class ScoreProcess {
 public:
  explicit ScoreProcess(const ScoreParameters& parameters);
  /// Score of the next quarter-hour.
  double next(const MarketCalendar& calendar, Random& random);

 private:
  const ScoreParameters& parameters_;
  std::array<UnitAutoregression, 3> parts_;
};

// From settled quarter-hours to the minute series: draws the minute path on each of them.

/// Gives quarter-hours without an imbalance a plausible one, for sources that publish prices only:
/// short where the price is above the median of the last day's, long below. Small enough that alpha
/// is 0. Returns how many it filled.
std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours);

/// `quarter_hours` ascending in time, not empty. Absent quarter-hours stay missing minutes; one
/// without an imbalance gets its settled price but no indicative ones.
MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed);

// Day-ahead prices for a simulated imbalance market: what the auction of the day before would have
// said of quarter-hours whose settled prices are given. Each hour's price is
//
//   D = profile by local hour + a (mean settled price of 3 hours on both sides - its mean)
//                             + b (the same of 12 hours) + noise
//
// the noise two autoregressions from hour to hour. Fitted to Belgium, May 2024 to June 2025:
// correlation with the settled quarter-hours 0.21 and 0.38 (2024, 2025), of day-ahead prices with
// those an hour later 0.94 and 0.92, a day later 0.70 and 0.76. Hours are repeated in their
// quarter-hours, as they were then.

/// The same seed gives the same prices everywhere. Needs the market's time zone.
DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed);

struct SimulationPeriod {
  std::int64_t start_utc_s;  ///< a local midnight
  std::int64_t end_utc_s;    ///< exclusive
};

/// Needs the market's time zone (set_market_time_zone). The same seed gives the same market
/// everywhere.
std::vector<QuarterHour> simulate_quarter_hours(const SimulationPeriod& period, std::uint64_t seed);

}  // namespace bess
