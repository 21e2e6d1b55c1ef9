// Rolling-horizon control (model-predictive) on a naive forecast. At every step it plans the next
// 24 hours by dynamic programming at forecast prices and executes the first action. Like any policy
// it knows the newest published price and its age.
//
// Forecast (persistence), with d = newest price - usual price of its quarter-hour:
//   rest of this quarter-hour   usual + s d        s: by minute of the quarter-hour, least squares
//   k quarter-hours later       usual + s d rho^k
// usual = mean settled price of the training days by quarter-hour of day; rho = their lag-1
// autocorrelation by quarter-hours. The deviation of a row older than usual decays further by rho.
//
// The forecast of later quarter-hours depends only on the quarter-hour of day and its deviation, so
// the value by SoC is tabulated once and replanning takes at most eight sweeps:
//   V_h(q, d) = sweep over the steps of q at usual(q) + d  of  V_{h-1}(q + 1, rho d),   V_0 = 0
#pragma once

#include <array>
#include <vector>

#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {

class RollingHorizonPolicy final : public Policy {
 public:
  /// Fits the forecast on `days` of `market`; throws UserError without days.
  RollingHorizonPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                       const BatteryParameters& battery);
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

  /// Expected profit, EUR, at `kSocPoints` even points of the SoC window.
  static constexpr int kSocPoints = 121;
  using Values = std::array<float, kSocPoints>;

 private:
  /// Of the newest price.
  [[nodiscard]] double observed_deviation(const MarketStep& step) const;
  [[nodiscard]] double deviation_now(const MarketStep& step) const;
  void fit_usual_prices(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_persistence(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_shrinkage(const MarketSteps& market, const std::vector<MarketDay>& days);
  void tabulate_values();
  /// Value by SoC with `steps` more steps of this quarter-hour, then `later` (laid out as value_).
  [[nodiscard]] Values plan(const std::vector<float>& later, int quarter_hour, double deviation,
                            int steps) const;

  BatteryParameters battery_;
  SocGrid grid_;
  BellmanSweep sweep_;
  std::array<double, kQuarterHourCount> usual_eur_per_mwh_{};
  std::array<double, kMinutesPerQuarterHour> shrinkage_{};  ///< s
  std::array<int, kMinutesPerQuarterHour>
      ordinary_age_quarter_hours_{};  ///< in quarter-hours, of the training days
  double persistence_ = 0;            ///< rho
  std::vector<float> value_;          ///< [quarter-hour][deviation][SoC point] EUR
};

}  // namespace bess
