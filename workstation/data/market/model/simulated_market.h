// Simulated imbalance market with the statistics of Belgium in 2023: quarter-hours with system
// imbalance, marginal prices and the settled price by the exact formula, in whole cents, from
// market_parameters.h. Also its distance from the real market's statistics.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/units_and_limits.h"
#include "workstation/base/random.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/imbalance_price.h"

namespace bess {

// Minute path: fifteen random indicative prices that end exactly at a settled price. Row m is
// computed at the END of minute m from the quarter-hour so far:
//   S_m      running mean of the instantaneous imbalance, an AR(1) path shifted so that its mean
//            over the fifteen minutes is the quarter-hour's SI
//   MIP_m    running maximum of the activated upward bids: a staircase that reaches the settled MIP
//            at a random minute (MDP_m falls likewise). No minute prices of the marginal regime are
//            public: the staircase is an assumption, its speed fitted to two later days of ods161
//   price_m  formula of imbalance_price.h on S_m, MIP_m, MDP_m. At minute 0 Elia does not know the
//            previous quarter-hour yet and takes its SI as 0 (1,596 of 1,598 rows of ods161)
// Used for simulated and real quarter-hours.

// Prices are in whole cents, like the settled ones of 2023.

inline double in_cents(double eur_per_mwh) {
  return std::round(100 * eur_per_mwh) / 100 + 0.0;  // + 0.0: no negative zero
}

// First-order autoregressive process with unit variance.

class UnitAutoregression {
 public:
  /// `correlation` between neighbours, -1 .. 1.
  explicit UnitAutoregression(double correlation) : correlation_(correlation) {}
  double next(Random& random);

 private:
  double correlation_;
  double value_ = 0;
  bool started_ = false;
};

using MinutePrices = std::array<double, kMinutesPerQuarterHour>;

/// Inputs of the fifteen prices of a quarter-hour, by minute, each for the quarter-hour so far.
struct MinutePath {
  std::array<double, kMinutesPerQuarterHour> imbalance_mw, incremental_eur_per_mwh,
      decremental_eur_per_mwh;
  double previous_imbalance_mw;
  double unexplained_eur_per_mwh;  ///< final difference to the formula; 0 if simulated
};

class MinutePathGenerator {
 public:
  explicit MinutePathGenerator(std::uint64_t seed);

  /// Path of the next quarter-hour in time. `quarter_hour` needs a price and an imbalance; the last
  /// known marginal price of that side replaces a missing one.
  MinutePath draw(const QuarterHour& quarter_hour);
  /// Prices of the path; the last one is the settled one.
  MinutePrices next(const QuarterHour& quarter_hour);

 private:
  using Path = std::array<double, kMinutesPerQuarterHour>;
  struct Sides {
    double incremental = 150;  ///< EUR/MWh; initially the usual price of 2023
    double decremental = 50;
  };

  Path imbalance_path(double mean_mw);
  Path staircase(double previous, double final, double direction);
  Sides final_sides(const QuarterHour& quarter_hour) const;

  Random random_;
  UnitAutoregression deviation_;
  Sides previous_sides_;
  double previous_imbalance_mw_ = 0;
};

// From settled quarter-hours to the minute series by drawing a minute path for each.

/// Adds a plausible imbalance where the source has prices only: short if the price is above the
/// last day's median, long below, and so small that alpha is 0. Returns the number added.
std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours);

/// `quarter_hours` ascending in time, not empty. Absent quarter-hours stay missing minutes; without
/// an imbalance a quarter-hour gets its settled price but no indicative ones.
MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed);

// Simulated day-ahead prices: result of the previous day's auction for quarter-hours whose settled
// prices are given. Each hour's price is
//
//   D = profile by local hour + a (mean settled price of 3 hours on both sides - its mean)
//                             + b (the same of 12 hours) + noise
//
// with two autoregressions from hour to hour as noise. Fitted to Belgium, May 2024 to June 2025:
// correlation with the settled quarter-hours 0.21 and 0.38 (2024, 2025), of day-ahead prices with
// those an hour later 0.94 and 0.92, a day later 0.70 and 0.76. Hours are repeated in their
// quarter-hours, as was the case then.

/// The same seed gives the same prices on every machine. Needs the market's time zone.
DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed);

/// `period` starts at a local midnight. Needs the market's time zone (set_market_time_zone). The
/// same seed gives the same market on every machine.
std::vector<QuarterHour> simulate_quarter_hours(const UtcSpan& period, std::uint64_t seed);

}  // namespace bess
