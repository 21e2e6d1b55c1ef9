// Stochastic dynamic program [SPEC 8]: the baseline that knows the hour and the price level, and
// the exact teacher. The newest price is split into what is usual and a deviation:
//
//   usual(q, level) = mean paid price of quarter-hour q, smoothed over the day
//                     + w (level - its mean)
//   deviation       = newest price - usual(quarter-hour that the price belongs to, level)
//
// Deviations are a Markov chain over 48 quantile bins, counted by phase of the half-hour and pooled
// over all hours, with the mean deviation paid in each bin. The value of stored energy follows by
// backward induction over a day of 720 steps that repeats for ever, for each of a few price levels.
// All of it is fitted on the days given; `level` is published by then, so nothing looks ahead.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "shared/battery_model.h"
#include "workstation/base/binary_file.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/deviation_chain.h"
#include "workstation/policy/planners/soc_grid.h"

namespace bess {

// The weight of a neighbour in a smoothed mean.

/// Gaussian, not normalised; `sigma` in the same steps as `distance`, 0: no smoothing.
inline double smoothing_kernel(int distance, double sigma) {
  if (sigma <= 0) return distance == 0 ? 1.0 : 0.0;
  return std::exp(-0.5 * distance * distance / (sigma * sigma));
}

// One backward step of the stochastic programs: what stored energy is worth now, by bin of the
// deviation and point of the SoC grid, from what it is worth a step later.
//   ahead[b][i] = gamma * sum over b' of P(b' | b, phase) * value[b'][i]
//   value[b][i] = max over actions of  ahead[b](SoC after it from point i) - cost of the exchange
// at the price that is expected to be paid: what is usual plus the bin's mean paid deviation.
//
// A full step moves most points of the grid by the same number of points: there the neighbours that
// are interpolated lie side by side, and the loop becomes vector code. A year by outlook takes
// millions of these steps.

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

struct StochasticProgramOptions {
  double level_weight = 0.6;   ///< w; 0: the usual price is the hour's alone
  int levels = 5;              ///< price levels that values are found for
  double gamma = 0.9995;       ///< discount a step
  double hour_smoothing = 4;   ///< of the usual price, quarter-hours
  double bin_smoothing = 0.5;  ///< of the counts, bins
};

class StochasticProgram {
 public:
  static constexpr int kPhases = DeviationChain::kPhases;
  static constexpr int kBins = DeviationChain::kBins;
  static constexpr int kSocPoints = 121;
  static constexpr int kQuarterHours = 96;

  /// What a decision is made on, apart from the SoC.
  struct Situation {
    int step_of_day;           ///< 0..719, local
    int row_quarter_hour;      ///< 0..95, of the newest price
    double price_eur_per_mwh;  ///< newest price
    double level_eur_per_mwh;  ///< trailing level
  };

  /// Fits on `days` of `market`; throws UserError when there are none.
  StochasticProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                    const BatteryParameters& battery, const StochasticProgramOptions& options = {});

  /// What was fitted, without what follows from it: reading solves again, to the same bits.
  void save(BinaryWriter& out) const;
  explicit StochasticProgram(BinaryReader& in);

  [[nodiscard]] static Situation situation_of(const MarketStep& step);
  /// The quarter-hour that the newest price belongs to at this minute of a quarter-hour, as it
  /// mostly was on the days fitted on: in the first minutes it is still the one before.
  [[nodiscard]] int row_quarter_hour(int quarter_hour, int minute_of_quarter_hour) const {
    return (quarter_hour - row_age_[static_cast<std::size_t>(minute_of_quarter_hour)] +
            kQuarterHours) %
           kQuarterHours;
  }
  /// What each action is worth, EUR until ever, up to a constant: [discharge, idle, charge].
  [[nodiscard]] std::array<double, kActionCount> action_values(const Situation& at,
                                                               double soc_frac) const;
  /// Value of the SoC grid's points [kSocPoints], EUR, for shaping rewards.
  void values(const Situation& at, float* value_eur) const;
  /// What action_values() is made of: the price that the step is expected to be paid at, and
  /// the discounted value of the SoC grid's points [kSocPoints] after it, EUR.
  [[nodiscard]] double expected_price(const Situation& at) const;
  void continuation(const Situation& at, float* value_eur) const;
  [[nodiscard]] double gamma() const { return options_.gamma; }
  [[nodiscard]] double mean_level_eur_per_mwh() const { return level_mean_; }
  [[nodiscard]] const BatteryParameters& battery() const { return battery_; }

 private:
  using Between = DeviationChain::Between;
  [[nodiscard]] double usual(int quarter_hour, double level) const;
  [[nodiscard]] double usual_paid(int step_of_day, double level) const;
  [[nodiscard]] Between between_levels(double level) const;
  void fit_usual(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days);
  void solve();
  /// The rows of `continuation_` that a situation lies between, with their weights, and what is
  /// expected to be paid.
  struct Outlook {
    std::array<std::size_t, 4> row;
    std::array<double, 4> weight;
    double price_eur_per_mwh;
  };
  [[nodiscard]] Outlook outlook(const Situation& at) const;
  /// Where in `continuation_` the SoC points of a level, step and bin begin.
  [[nodiscard]] static std::size_t continuation_at(int level, int step_of_day, int bin) {
    return ((static_cast<std::size_t>(level) * kStepsPerDay + step_of_day) * kBins + bin) *
           kSocPoints;
  }

  BatteryParameters battery_;
  StochasticProgramOptions options_;
  SocGrid grid_;
  std::array<double, kQuarterHours> usual_{};  ///< EUR/MWh at the mean level
  std::array<int, kMinutesPerQuarterHour>
      row_age_{};  ///< quarter-hours ago, by minute of the quarter-hour
  double level_mean_ = 0;
  std::vector<double> levels_;  ///< that values are known for, ascending
  DeviationChain chain_;
  std::vector<float>
      continuation_;  ///< [level][step][bin][SoC point] discounted expected value, EUR
};

class StochasticProgramPolicy final : public Policy {
 public:
  StochasticProgramPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                          const BatteryParameters& battery,
                          const StochasticProgramOptions& options = {})
      : program_(market, days, battery, options) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override {
    const auto worth = program_.action_values(StochasticProgram::situation_of(step), soc_frac);
    return argmax_action(worth.data());
  }

 private:
  StochasticProgram program_;
};

}  // namespace bess
