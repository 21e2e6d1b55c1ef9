// Tabular value iteration: the classical baseline that fits in two seconds [SPEC 8].
// State: phase of the half-hour (15), bin of the observed price (48 quantile bins of the training
// decisions), SoC (181 points). The price is a Markov chain from (phase, bin) to the next phase's
// bin, counted on training days; the reward is the mean import or export price in each (phase,
// bin). gamma 0.999, continuing.
#pragma once

#include <vector>

#include "shared/battery_model.h"
#include "workstation/env/policy.h"

namespace bess {

class TabularPolicy final : public Policy {
 public:
  /// Fits on `days` of `market`; throws UserError when there are none.
  TabularPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                const BatteryParameters& battery);
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

 private:
  [[nodiscard]] int price_bin(double price_eur_per_mwh) const;
  void count_market(const MarketSteps& market, const std::vector<MarketDay>& days);
  void iterate_values();

  BatteryParameters battery_;
  std::vector<double> bin_edges_;  ///< [47] ascending
  std::vector<double> import_;  ///< [phase][bin] mean price of a MWh taken, trading costs included
  std::vector<double> export_;  ///< the same of a MWh given
  std::vector<float> transition_;  ///< [phase][bin][next bin] probability
  std::vector<Action> greedy_;     ///< [phase][bin][SoC point]
};

}  // namespace bess
