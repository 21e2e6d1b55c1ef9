// Perfect foresight: the most that any controller with these three actions could have earned, by
// dynamic programming over the settled prices. A bound to compare with, never a policy: it reads
// the future. 901 SoC points with linear interpolation (181 are too coarse) [SPEC 8].
#pragma once

#include <vector>

#include "shared/battery_model.h"
#include "workstation/env/policy.h"

namespace bess {

class ForesightPolicy final : public Policy {
 public:
  explicit ForesightPolicy(const BatteryParameters& battery);
  void begin(std::span<const MarketStep> day) override;  ///< plans this day; its end is free
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

 private:
  BatteryParameters battery_;
  std::vector<float> value_;  ///< [step + 1][SoC point] EUR still to earn
};

}  // namespace bess
