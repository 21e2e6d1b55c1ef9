// Perfect foresight: the most that any controller with these three actions could have earned, by
// dynamic programming over the settled prices. A bound to compare with, never a policy: it reads
// the future. 1801 SoC points with linear interpolation: 181 are too coarse, 901 [SPEC 8] lose
// another 0.1 EUR/day/MWh.
// It plans all the steps it is given, their end free. Values of the SoC are kept at block borders
// only and a block is solved again when it is entered: a year takes a few megabytes instead of two
// gigabytes, for twice the time.
// With a limit on daily cycles each local day has its own shadow price, found by
// planning and running the steps again; what it then earns is a plan that keeps the limit, a little
// under the true bound.
#pragma once

#include <array>
#include <vector>

#include "shared/battery_model.h"
#include "shared/exchange_cost.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/soc_grid.h"

namespace bess {

// One backward step of dynamic programming over the SoC at a known price, the inner loop of the
// foresight bound and of rolling-horizon control:
//   now[i] = max over actions a of  next(SoC after a from point i) - cost of the exchange.
// On an even grid a full-power action moves every point by the same distance, so all but the points
// next to a bound read `next` shifted: a straight loop that the compiler turns into vector code.

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

// A limit on equivalent full cycles by its shadow price: throughput beyond the limit is not worth
// more than lambda EUR/MWh, so a planner that counts lambda as extra wear keeps the limit by itself
// and saves its cycles for the hours that pay best, where one that knows nothing of it uses them up
// in the morning. Cycles fall with lambda, so bisection finds the smallest that suffices
// [Everett 1963, generalised Lagrange multipliers].

inline constexpr double kShadowPriceMaxEurPerMwh = 5'000;
inline constexpr int kShadowPriceBisections = 16;  ///< to 0.1 EUR/MWh

/// The bracket of one limit's shadow price, narrowed by what a trial price leads to.
class ShadowPrice {
 public:
  /// To be tried next, EUR/MWh of throughput; 0 at first.
  [[nodiscard]] double trial() const { return tried_ ? 0.5 * (low_ + high_) : 0.0; }
  /// Once every bisection is done: keeps the limit.
  [[nodiscard]] double found() const { return high_; }
  /// Tells whether the last trial kept the limit.
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
