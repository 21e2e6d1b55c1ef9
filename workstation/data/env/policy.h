// Policy interface: published prices and SoC to an action.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <string>

#include "shared/action.h"
#include "shared/battery_model.h"
#include "workstation/data/env/market_steps.h"

namespace bess {

class Policy {
 public:
  Policy() = default;
  Policy(const Policy&) = delete;
  Policy& operator=(const Policy&) = delete;
  virtual ~Policy() = default;

  /// Called before each run of consecutive steps that starts at `soc_frac`. Only foresight, which
  /// is a bound and not a policy, uses `ahead`.
  virtual void begin(std::span<const MarketStep> /*ahead*/, double /*soc_frac*/) {}

  /// True for foresight only: with the SoC carried over, evaluate() plans and runs the whole series
  /// (evaluate.h).
  [[nodiscard]] virtual bool sees_future() const { return false; }
  /// Fitted parameters as text; empty if they do not fit in a line.
  [[nodiscard]] virtual std::string description() const { return {}; }
  /// Decides one step. `index` counts from the last begin().
  [[nodiscard]] virtual Action decide(const MarketStep& step, std::size_t index,
                                      double soc_frac) const = 0;
  /// Usable share of the rated power, 0..1.
  [[nodiscard]] virtual double power_share_max(const MarketStep& /*step*/,
                                               double /*soc_frac*/) const {
    return 1;
  }
};

/// Power of an action at a step, W, within the limits of the policy and the hour.
inline double ordered_power_w(const BatteryParameters& battery, const MarketStep& step,
                              Action action, double power_share_max) {
  const double share = std::min(power_share_max, battery.cold.share_at(step.quarter_hour));
  return power_sign(action) * battery.power_w_max * share;
}

/// Charges below `low`, discharges above `high`, idles between [Paper, Eq. 13].
class RuleBasedPolicy final : public Policy {
 public:
  RuleBasedPolicy(double low_eur_per_mwh, double high_eur_per_mwh)
      : low_(low_eur_per_mwh), high_(high_eur_per_mwh) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double) const override {
    if (step.observed_eur_per_mwh < low_) return Action::kCharge;
    return step.observed_eur_per_mwh > high_ ? Action::kDischarge : Action::kIdle;
  }
  [[nodiscard]] std::string description() const override {
    return fmt::format("charge below {:g}, discharge above {:g} EUR/MWh", low_, high_);
  }

 private:
  double low_;
  double high_;
};

/// The paper's thresholds: quartiles of the whole of 2023, hence with look-ahead [SPEC 4].
inline constexpr double kPaperRuleLowEurPerMwh = 11;
inline constexpr double kPaperRuleHighEurPerMwh = 179;

}  // namespace bess
