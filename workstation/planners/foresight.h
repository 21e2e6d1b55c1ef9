// Perfect foresight: the most that any controller with these three actions could have earned, by
// dynamic programming over the settled prices. A bound to compare with, never a policy: it reads
// the future. 1801 SoC points with linear interpolation: 181 are too coarse, 901 [SPEC 8] lose
// another 0.1 EUR/day/MWh.
// It plans all the steps it is given, their end free. Values of the SoC are kept at block borders
// only and a block is solved again when it is entered: a year takes a few megabytes instead of two
// gigabytes, for twice the time.
// With a limit on daily cycles each local day has its own shadow price (shadow_price.h), found by
// planning and running the steps again; what it then earns is a plan that keeps the limit, a little
// under the true bound.
#pragma once

#include <vector>

#include "shared/battery_model.h"
#include "workstation/env/policy.h"
#include "workstation/planners/bellman_sweep.h"

namespace bess {

class ForesightPolicy final : public Policy {
 public:
  explicit ForesightPolicy(const BatteryParameters& battery);
  void begin(std::span<const MarketStep> ahead, double soc_frac) override;
  [[nodiscard]] bool sees_future() const override { return true; }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;
  /// What exchanging `wanted_power_w` (charge positive), or what the cold leaves of it, is worth at
  /// this step and SoC when every later decision is the best one: EUR of the step and of what is
  /// left to earn. Within a local day two of them can be compared; under a limit on cycles
  /// throughput costs its shadow price.
  [[nodiscard]] double worth_eur(std::size_t index, double soc_frac, double wanted_power_w) const;

 private:
  [[nodiscard]] BatteryParameters shadowed(std::size_t index) const;
  [[nodiscard]] const float* values_after(std::size_t index) const;
  void plan();
  void solve_block(std::size_t block) const;
  void find_shadow_prices(std::span<const MarketStep> ahead, double soc_frac);
  [[nodiscard]] Action best(std::size_t index, double soc_frac) const;

  BatteryParameters battery_;
  SocGrid grid_;
  BellmanSweep sweep_;
  std::vector<float> paid_;                ///< [step] EUR/MWh
  std::vector<std::int8_t> quarter_hour_;  ///< [step] local
  std::vector<float> shadow_;              ///< [step] EUR/MWh of throughput, one value a local day
  std::vector<float> border_;  ///< [block + 1][SoC point] EUR still to earn, up to a constant
  mutable std::size_t solved_block_ = 0;
  mutable std::vector<float> value_;  ///< [step of the block + 1][SoC point]
};

}  // namespace bess
