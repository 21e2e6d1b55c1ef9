// Perfect foresight: upper bound of the profit with these three actions, by dynamic programming
// over the settled prices. Not a policy, as it uses future prices. 1801 SoC points with linear
// interpolation: 181 are too few, 901 [SPEC 8] lose another 0.1 EUR/day/MWh. All given steps are
// planned, with a free end. Values of the SoC are stored at block borders only, and a block is
// solved again when it is entered: a year takes a few megabytes instead of two gigabytes, for twice
// the time. With a limit on daily full cycles each local day has its own shadow price, found by
// planning and running the steps repeatedly; the result meets the limit and is slightly below the
// true bound.
#pragma once

#include <array>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/soc_grid.h"

namespace bess {

// Backward step of dynamic programming over the SoC at a known price, the inner loop of foresight
// and rolling-horizon control:
//   now[i] = max over actions a of  next(SoC after a from point i) - cost of the exchange.
// On an even grid full power moves every point by the same distance, so all points except those
// near a bound read `next` shifted: a straight loop that the compiler vectorises.

class BellmanSweep {
 public:
  BellmanSweep(const BatteryParameters& battery, const SocGrid& grid);

  /// For a step in a local quarter-hour of the day. `next` and `now` have one value (EUR) for each
  /// grid point and must not overlap. `price_eur_per_mwh` is the market's; trading costs and wear
  /// are added, and `shadow_eur_per_mwh` counts like wear.
  void run(const float* next, int quarter_hour, float price_eur_per_mwh, float* now,
           float shadow_eur_per_mwh = 0) const;

 private:
  /// Charging or discharging at full power.
  struct Direction {
    int shift;            ///< points from i to the lower neighbour of the SoC reached
    float weight;         ///< weight of the upper neighbour
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

/// The best action at any SoC, given the values `next` of the grid points after it.
Action best_action(const BatteryParameters& battery, const SocGrid& grid, const float* next,
                   int quarter_hour, double price_eur_per_mwh, double soc_frac);

// Limit on equivalent full cycles by its shadow price lambda, EUR/MWh: throughput that earns less
// than lambda is not traded. A planner that counts lambda as additional wear meets the limit and
// saves its cycles for the most profitable hours, whereas one without it uses them up in the
// morning. Cycles decrease with lambda, so bisection finds the smallest sufficient value [Everett
// 1963, generalised Lagrange multipliers].

inline constexpr double kShadowPriceMaxEurPerMwh = 5'000;
inline constexpr int kShadowPriceBisections = 16;  ///< to 0.1 EUR/MWh

/// Bracket of one limit's shadow price, narrowed by the result of each trial price.
class ShadowPrice {
 public:
  /// Next price to try, EUR/MWh of throughput; initially 0.
  [[nodiscard]] double trial() const { return tried_ ? 0.5 * (low_ + high_) : 0.0; }
  /// Result after all bisections: meets the limit.
  [[nodiscard]] double found() const { return high_; }
  /// Records whether the last trial met the limit.
  void learn(bool kept) {
    if (!tried_) {
      if (kept) high_ = 0;
      tried_ = true;
      return;
    }
    double& bound = kept ? high_ : low_;
    bound = 0.5 * (low_ + high_);
  }

 private:
  double low_ = 0;
  double high_ = kShadowPriceMaxEurPerMwh;
  bool tried_ = false;
};

class ForesightPolicy final : public Policy {
 public:
  explicit ForesightPolicy(const BatteryParameters& battery);
  void begin(std::span<const MarketStep> ahead, double soc_frac) override;
  [[nodiscard]] bool sees_future() const override { return true; }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;
  /// Value of exchanging `wanted_power_w` (charge positive, limited by cold) at this step and SoC
  /// with optimal later decisions: EUR of the step and of the future. Two values are comparable
  /// within a local day; under a limit on full cycles throughput costs its shadow price.
  [[nodiscard]] double worth_eur(std::size_t index, double soc_frac, double wanted_power_w) const;

 private:
  [[nodiscard]] BatteryParameters shadowed(std::size_t index) const;
  [[nodiscard]] const float* values_after(std::size_t index) const;
  void plan();
  void solve_block(std::size_t block) const;
  void find_shadow_prices(std::span<const MarketStep> ahead, double soc_frac);

  BatteryParameters battery_;
  SocGrid grid_;
  BellmanSweep sweep_;
  std::vector<float> paid_;                ///< [step] EUR/MWh
  std::vector<std::int8_t> quarter_hour_;  ///< [step] local
  std::vector<float> shadow_;              ///< [step] EUR/MWh of throughput, by local day
  std::vector<float> border_;              ///< [block + 1][SoC point] future EUR, up to a constant
  mutable std::size_t solved_block_ = 0;
  mutable std::vector<float> value_;  ///< [step of the block + 1][SoC point]
};

// Planner with a limit on daily full cycles: fitted with the limit's shadow price as additional
// wear (ShadowPrice), so that the limit is met on average over the fitted days. The evaluation
// enforces it each day.

/// Battery to plan with: `battery` itself without a limit.
template <typename Planner, typename... Options>
BatteryParameters battery_with_shadow_price(const MarketSteps& market,
                                            const std::vector<MarketDay>& days,
                                            const BatteryParameters& battery,
                                            const Options&... options) {
  BatteryParameters shadowed = battery;
  shadowed.cycles_per_day_max = 0;
  if (battery.cycles_per_day_max <= 0) return shadowed;
  ShadowPrice price;
  for (int trial = 0; trial <= kShadowPriceBisections; ++trial) {
    shadowed.wear_eur_per_mwh = battery.wear_eur_per_mwh + price.trial();
    Planner planner(market, days, shadowed, options...);
    const double start_frac = 0.5 * (battery.soc_min_frac + battery.soc_max_frac);
    const Evaluation run = evaluate(market, days, planner, {shadowed, start_frac, true});
    price.learn(run.cycles_per_day() <= battery.cycles_per_day_max);
    if (price.found() == 0) break;
  }
  shadowed.wear_eur_per_mwh = battery.wear_eur_per_mwh + price.found();
  return shadowed;
}

}  // namespace bess
