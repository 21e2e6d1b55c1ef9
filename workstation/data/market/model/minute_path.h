// The fifteen indicative prices on the way to a settled quarter-hour, drawn at random but exact at
// the end. Row m is computed at the END of minute m from everything since the quarter-hour began:
//   S_m      running mean of the instantaneous imbalance, an AR(1) path shifted so that its mean
//            over the fifteen minutes is the quarter-hour's SI
//   MIP_m    running maximum of the activated upward bids: a staircase that reaches the settled MIP
//            at a random minute (MDP_m falls likewise). No minute prices of the marginal regime are
//            public: the staircase is an assumption, its speed fitted to two later days of ods161
//   price_m  the formula of imbalance_price.h on S_m, MIP_m, MDP_m. At minute 0 Elia does not know
//            the previous quarter-hour yet and takes its SI as 0 (1,596 of 1,598 rows of ods161)
// Used on simulated and on real quarter-hours alike.
#pragma once

#include <array>
#include <cmath>

#include "shared/units_and_limits.h"
#include "workstation/base/random.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

// Drawn prices are made in whole cents, as the settled ones of 2023 are published.

inline double in_cents(double eur_per_mwh) {
  return std::round(100 * eur_per_mwh) / 100 + 0.0;  // + 0.0: no negative zero
}

// First-order autoregressive process with unit variance: the memory of the simulated market.

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

/// What the fifteen prices of a quarter-hour are made of; by minute, each of everything so far.
struct MinutePath {
  std::array<double, kMinutesPerQuarterHour> imbalance_mw, incremental_eur_per_mwh,
      decremental_eur_per_mwh;
  double previous_imbalance_mw;
  double unexplained_eur_per_mwh;  ///< what the formula leaves at the end; 0 of a simulated one
};

class MinutePathGenerator {
 public:
  explicit MinutePathGenerator(std::uint64_t seed);

  /// Path of the next quarter-hour in time. `quarter_hour` needs a price and an imbalance; a
  /// missing marginal price is replaced by the last one seen on that side.
  MinutePath draw(const QuarterHour& quarter_hour);
  /// Its prices; the last one is the settled one.
  MinutePrices next(const QuarterHour& quarter_hour);

 private:
  using Path = std::array<double, kMinutesPerQuarterHour>;
  struct Sides {
    double incremental = 150;  ///< EUR/MWh; before anything was seen: the usual price of 2023
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
