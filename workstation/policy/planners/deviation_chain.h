// Markov chain of the price deviation over 48 quantile bins: deviation of the newest price from the
// usual price, counted by phase of the half-hour and pooled over all hours, with the mean paid
// deviation of each bin. The calling program defines the usual price.
#pragma once

#include <array>
#include <vector>

#include "shared/units_and_limits.h"
#include "workstation/base/binary_file.h"
#include "workstation/data/env/market_steps.h"

namespace bess {

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

}  // namespace bess
