// One backward step of the stochastic programs: what stored energy is worth now, by bin of the
// deviation and point of the SoC grid, from what it is worth a step later.
//   ahead[b][i] = gamma * sum over b' of P(b' | b, phase) * value[b'][i]
//   value[b][i] = max over actions of  ahead[b](SoC after it from point i) - cost of the exchange
// at the price that is expected to be paid: what is usual plus the bin's mean paid deviation.
#pragma once

#include <vector>

#include "shared/battery_model.h"
#include "workstation/planners/deviation_chain.h"
#include "workstation/planners/soc_grid.h"

namespace bess {

class StorageRecursion {
 public:
  StorageRecursion(const BatteryParameters& battery, const SocGrid& grid, double gamma);

  /// `value` [bin][SoC point] of the next step becomes this step's; `ahead`, of the same shape, is
  /// written. EUR.
  void step_back(const DeviationChain& chain, int phase, double usual_eur_per_mwh, float* ahead,
                 float* value) const;

 private:
  BatteryParameters battery_;
  int points_;
  double gamma_;
  std::vector<GridMove> moves_;
};

}  // namespace bess
