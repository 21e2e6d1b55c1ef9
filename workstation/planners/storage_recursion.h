// One backward step of the stochastic programs: what stored energy is worth now, by bin of the
// deviation and point of the SoC grid, from what it is worth a step later.
//   ahead[b][i] = gamma * sum over b' of P(b' | b, phase) * value[b'][i]
//   value[b][i] = max over actions of  ahead[b](SoC after it from point i) - cost of the exchange
// at the price that is expected to be paid: what is usual plus the bin's mean paid deviation.
//
// A full step moves most points of the grid by the same number of points: there the neighbours that
// are interpolated lie side by side, and the loop becomes vector code. A year by outlook takes
// millions of these steps.
#pragma once

#include <array>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/planners/deviation_chain.h"
#include "workstation/planners/soc_grid.h"

namespace bess {

class StorageRecursion {
 public:
  StorageRecursion(const BatteryParameters& battery, const SocGrid& grid, double gamma);

  /// Of a step in a local quarter-hour of the day: `value` [bin][SoC point] of the next step
  /// becomes this step's; `ahead`, of the same shape, is written. EUR.
  void step_back(const DeviationChain& chain, int phase, int quarter_hour, double usual_eur_per_mwh,
                 float* ahead, float* value) const;

 private:
  /// What charging or discharging does, by point of the grid.
  struct Direction {
    std::vector<int> lower;     ///< neighbour of the SoC after it
    std::vector<float> weight;  ///< of the upper neighbour
    std::vector<float> energy_mwh;
    double full_mwh;  ///< where all of it fits
    int shift;        ///< of the run: lower[i] = i + shift for i in [first, end)
    int first, end;
  };
  [[nodiscard]] static Direction make_direction(const std::vector<GridMove>& moves, Action action,
                                                int points);
  void improve(const Direction& direction, double price_eur_per_mwh, const float* ahead,
               float* value) const;

  BatteryParameters battery_;
  int points_;
  double gamma_;
  std::array<std::array<Direction, 2>, 2> directions_;  ///< of usual and of cold hours
};

}  // namespace bess
