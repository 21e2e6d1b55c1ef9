// One backward step of dynamic programming over the SoC at a known price, the inner loop of the
// foresight bound and of rolling-horizon control:
//   now[i] = max over actions a of  next(SoC after a from point i) - cost of the exchange.
// On an even grid a full-power action moves every point by the same distance, so all but the points
// next to a bound read `next` shifted: a straight loop that the compiler turns into vector code.
#pragma once

#include <array>
#include <vector>

#include "shared/exchange_cost.h"
#include "workstation/planners/soc_grid.h"

namespace bess {

class BellmanSweep {
 public:
  BellmanSweep(const BatteryParameters& battery, const SocGrid& grid);

  /// Of a step in a local quarter-hour of the day.
  /// `next` and `now` hold one value (EUR) for each point of the grid and must not overlap.
  /// `price_eur_per_mwh` is the market's: trading costs and wear come on top, and
  /// `shadow_eur_per_mwh` is counted like wear.
  void run(const float* next, int quarter_hour, float price_eur_per_mwh, float* now,
           float shadow_eur_per_mwh = 0) const;

 private:
  /// Charging or discharging at full power.
  struct Direction {
    int shift;            ///< points from i to the lower neighbour of the SoC reached
    float weight;         ///< of its upper neighbour
    float energy_mwh;     ///< at full power, grid side, charge positive
    int first_unbounded;  ///< points [first, end) exchange full power
    int end_unbounded;
    std::vector<GridMove> moves;  ///< [point]
  };
  [[nodiscard]] Direction make_direction(const BatteryParameters& battery, Action action,
                                         double power_share) const;
  void improve(const Direction& direction, const float* next, float price, float wear,
               float* now) const;

  SocGrid grid_;
  ColdHours cold_;
  TradingCosts costs_;
  float wear_eur_per_mwh_;
  std::array<std::array<Direction, 2>, 2> directions_;  ///< of usual and of cold hours
};

/// The action from any SoC when `next` values the grid's points after it.
Action best_action(const BatteryParameters& battery, const SocGrid& grid, const float* next,
                   int quarter_hour, double price_eur_per_mwh, double soc_frac);

}  // namespace bess
