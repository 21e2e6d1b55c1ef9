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
#pragma once

#include <array>
#include <cmath>

#include "shared/units_and_limits.h"
#include "workstation/base/random.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

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

}  // namespace bess
