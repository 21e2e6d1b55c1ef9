// Stochastic dynamic program [SPEC 8]: baseline with hour and price level, and the exact teacher.
// The newest price is the sum of a usual price and a deviation:
//
//   usual(q, level) = mean paid price of quarter-hour q, smoothed over the day
//                     + w (level - its mean)
//   deviation       = newest price - usual(quarter-hour of the price, level)
//
// Deviations are a Markov chain over 48 quantile bins, counted by phase of the half-hour and pooled
// over all hours, with the mean deviation paid in each bin. The value of stored energy follows by
// backward induction over a periodic day of 720 steps, for each of a few price levels. Everything
// is fitted on the given days; `level` is already published, so there is no look-ahead.
#pragma once

#include <array>
#include <vector>

#include "shared/battery_model.h"
#include "shared/units_and_limits.h"
#include "workstation/base/binary_file.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/policy.h"
#include "workstation/policy/planners/soc_grid.h"

namespace bess {

// Markov chain of the price deviation over 48 quantile bins: deviation of the newest price from the
// usual price, counted by phase of the half-hour and pooled over all hours, with the mean paid
// deviation of each bin. The calling program defines the usual price.

class DeviationChain {
 public:
  static constexpr int kPhases = 15;
  static constexpr int kBins = 48;

  /// An observed step.
  struct Sample {
    int phase;              ///< of the half-hour, 0..14
    double deviation;       ///< newest minus usual price, EUR/MWh
    double paid_deviation;  ///< paid minus usual price, EUR/MWh
    bool follows;           ///< the previous sample is the previous step in time
  };

  DeviationChain() = default;
  /// `bin_smoothing`: of the counts, in bins. `samples` must not be empty.
  DeviationChain(const std::vector<Sample>& samples, double bin_smoothing);

  void save(BinaryWriter& out) const;
  explicit DeviationChain(BinaryReader& in);

  /// Position between two bins' mean deviations.
  struct BinPosition {
    int lower;
    double weight;  ///< of the upper neighbour
  };
  [[nodiscard]] BinPosition between(double deviation) const;
  /// Mean deviation of the newest price in a bin, EUR/MWh.
  [[nodiscard]] double centre(int bin) const { return bin_centres_[static_cast<std::size_t>(bin)]; }
  /// Mean deviation paid, EUR/MWh.
  [[nodiscard]] double paid(int phase, int bin) const { return paid_[phase * kBins + bin]; }
  [[nodiscard]] double paid(int phase, BinPosition bins) const {
    const double* at = &paid_[phase * kBins + bins.lower];
    return at[0] + bins.weight * (at[1] - at[0]);
  }
  /// [bin][next bin]: transition probabilities of a step of this phase.
  [[nodiscard]] const float* transition(int phase) const {
    return &transition_[phase * kBins * kBins];
  }

 private:
  void fit_bins(const std::vector<Sample>& samples);
  void count(const std::vector<Sample>& samples, double bin_smoothing);
  [[nodiscard]] int bin_of(double deviation) const;

  std::vector<double> bin_edges_;    ///< [47] ascending
  std::vector<double> bin_centres_;  ///< [48] mean deviations
  std::vector<double> paid_;         ///< [phase][bin] mean paid deviation
  std::vector<float> transition_;    ///< [phase][bin][next bin]
};

// Parts that the two programs share.

inline constexpr double kProgramGamma = 0.9995;  ///< discount per step
inline constexpr double kHourSmoothing = 4;      ///< of means by hour, quarter-hours
inline constexpr double kBinSmoothing = 0.5;     ///< of the chain's counts, bins

/// Sums by local quarter-hour, for a smoothed mean.
struct MeanByQuarterHour {
  std::array<double, kQuarterHourCount> sum{}, count{};

  void add(int quarter_hour, double value) {
    sum[static_cast<std::size_t>(quarter_hour)] += value;
    count[static_cast<std::size_t>(quarter_hour)] += 1;
  }
  [[nodiscard]] double weight() const;
  /// Where no quarter-hour within reach has a value: the mean of all.
  [[nodiscard]] std::array<double, kQuarterHourCount> smoothed(double sigma) const;
};

// Price levels with values, and the present level between them.

struct PriceLevels {
  double mean;                 ///< of the fitted steps
  std::vector<double> levels;  ///< evenly spaced within three standard deviations of it
};
inline constexpr int kLevelCount = 5;
/// (As a constant of this function, the count would let the compiler round the last bit otherwise.)
PriceLevels fit_levels(const MarketSteps& market, const std::vector<MarketDay>& days,
                       int level_count);

DeviationChain::BinPosition between_levels(const std::vector<double>& levels, double level);

// Backward step of the stochastic programs: present value of stored energy, by bin of the deviation
// and point of the SoC grid, from the value one step later.
//   ahead[b][i] = gamma * sum over b' of P(b' | b, phase) * value[b'][i]
//   value[b][i] = max over actions of  ahead[b](SoC after it from point i) - cost of the exchange
// at the expected price: usual price plus the bin's mean paid deviation.
//
// A full step moves most grid points by the same number of points: the neighbours for interpolation
// are then adjacent, and the loop vectorises. A year with the outlook takes millions of these
// steps.

class StorageRecursion {
 public:
  StorageRecursion(const BatteryParameters& battery, const SocGrid& grid, double gamma);

  /// For a step in a local quarter-hour of the day: replaces `value` [bin][SoC point] of the next
  /// step by this step's; writes `ahead`, of the same shape. EUR.
  void step_back(const DeviationChain& chain, int phase, int quarter_hour, double usual_eur_per_mwh,
                 float* ahead, float* value) const;

 private:
  /// Result of charging or discharging, by grid point.
  struct Direction {
    std::vector<int> lower;     ///< neighbour of the SoC after it
    std::vector<float> weight;  ///< weight of the upper neighbour
    std::vector<float> energy_mwh;
    double full_mwh;  ///< at full power
    int shift;        ///< lower[i] = i + shift for i in [first, end)
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

inline constexpr double kLevelWeight = 0.6;  ///< w; 0: the usual price depends on the hour only

class StochasticProgram {
 public:
  static constexpr int kPhases = DeviationChain::kPhases;
  static constexpr int kBins = DeviationChain::kBins;
  static constexpr int kSocPoints = 121;

  /// Inputs of a decision without the SoC.
  struct MarketState {
    int step_of_day;           ///< 0..719, local
    int row_quarter_hour;      ///< 0..95, of the newest price
    double price_eur_per_mwh;  ///< newest price
    double level_eur_per_mwh;  ///< trailing level
  };

  /// Fits on `days` of `market`; throws UserError without days.
  StochasticProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                    const BatteryParameters& battery, double level_weight = kLevelWeight);

  /// Fitted values only: reading recomputes the rest, bit-identical.
  void save(BinaryWriter& out) const;
  explicit StochasticProgram(BinaryReader& in);

  [[nodiscard]] static MarketState market_state_of(const MarketStep& step);
  /// Most frequent quarter-hour of the newest price at this minute on the fitted days; in the first
  /// minutes it is the previous quarter-hour.
  [[nodiscard]] int row_quarter_hour(int quarter_hour, int minute_of_quarter_hour) const {
    return (quarter_hour - row_age_[static_cast<std::size_t>(minute_of_quarter_hour)] +
            kQuarterHourCount) %
           kQuarterHourCount;
  }
  /// Value of each action, EUR over an infinite horizon, up to a constant: [discharge, idle,
  /// charge].
  [[nodiscard]] std::array<double, kActionCount> action_values(const MarketState& at,
                                                               double soc_frac) const;
  /// Writes the discounted value of the SoC grid's points [kSocPoints] after the step, EUR; returns
  /// its expected price. action_values() consists of the two.
  double continuation(const MarketState& at, float* value_eur) const;
  [[nodiscard]] double gamma() const { return gamma_; }
  [[nodiscard]] double mean_level_eur_per_mwh() const { return level_mean_; }
  [[nodiscard]] const BatteryParameters& battery() const { return battery_; }

 private:
  using BinPosition = DeviationChain::BinPosition;
  [[nodiscard]] double usual(int quarter_hour, double level) const;
  [[nodiscard]] double usual_paid(int step_of_day, double level) const;
  void fit_usual(const MarketSteps& market, const std::vector<MarketDay>& days);
  void fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days);
  void solve();
  /// Rows of `continuation_` around a situation with their weights, and the expected price.
  struct Outlook {
    std::array<std::size_t, 4> row;
    std::array<double, 4> weight;
    double price_eur_per_mwh;
  };
  [[nodiscard]] Outlook outlook(const MarketState& at) const;
  /// Index in `continuation_` of the first SoC point of a level, step and bin.
  [[nodiscard]] static std::size_t continuation_at(int level, int step_of_day, int bin) {
    return ((static_cast<std::size_t>(level) * kStepsPerDay + step_of_day) * kBins + bin) *
           kSocPoints;
  }

  BatteryParameters battery_;
  double level_weight_ = 0;
  double gamma_ = kProgramGamma;
  SocGrid grid_;
  std::array<double, kQuarterHourCount> usual_{};  ///< EUR/MWh at the mean level
  std::array<int, kMinutesPerQuarterHour>
      row_age_{};  ///< quarter-hours ago, by minute of the quarter-hour
  double level_mean_ = 0;
  std::vector<double> levels_;  ///< price levels with values, ascending
  DeviationChain chain_;
  std::vector<float>
      continuation_;  ///< [level][step][bin][SoC point] discounted expected value, EUR
};

class StochasticProgramPolicy final : public Policy {
 public:
  StochasticProgramPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                          const BatteryParameters& battery, double level_weight = kLevelWeight)
      : program_(market, days, battery, level_weight) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override {
    const auto worth = program_.action_values(StochasticProgram::market_state_of(step), soc_frac);
    return argmax_action(worth.data());
  }

 private:
  StochasticProgram program_;
};

}  // namespace bess
