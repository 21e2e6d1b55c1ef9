// How the newest price moves around what is usual: its deviation is a Markov chain over 48 quantile
// bins, counted by phase of the half-hour and pooled over all hours, with the mean deviation that
// is paid in each bin. What "usual" is, the program that asks decides.
#pragma once

#include <array>
#include <vector>

#include "workstation/base/binary_file.h"

namespace bess {

class DeviationChain {
 public:
  static constexpr int kPhases = 15;
  static constexpr int kBins = 48;

  /// A step that was seen.
  struct Sample {
    int phase;              ///< of the half-hour, 0..14
    double deviation;       ///< newest price minus what is usual, EUR/MWh
    double paid_deviation;  ///< the same of what the step is paid at
    bool follows;           ///< the sample before it in the list is the step before it in time
  };

  DeviationChain() = default;
  /// `bin_smoothing`: of the counts, bins. Not of no sample.
  DeviationChain(const std::vector<Sample>& samples, double bin_smoothing);

  void save(BinaryWriter& out) const;
  explicit DeviationChain(BinaryReader& in);

  /// How far between two bins' mean deviations something lies.
  struct Between {
    int lower;
    double weight;  ///< of the upper neighbour
  };
  [[nodiscard]] Between between(double deviation) const;
  /// Mean deviation of the newest price in a bin, EUR/MWh.
  [[nodiscard]] double centre(int bin) const { return bin_centres_[static_cast<std::size_t>(bin)]; }
  /// Mean deviation paid, EUR/MWh.
  [[nodiscard]] double paid(int phase, int bin) const { return paid_[phase * kBins + bin]; }
  [[nodiscard]] double paid(int phase, Between bins) const {
    const double* at = &paid_[phase * kBins + bins.lower];
    return at[0] + bins.weight * (at[1] - at[0]);
  }
  /// [bin][next bin]: the probability of each bin after a step of this phase.
  [[nodiscard]] const float* transition(int phase) const {
    return &transition_[phase * kBins * kBins];
  }

 private:
  void fit_bins(const std::vector<Sample>& samples);
  void count(const std::vector<Sample>& samples, double bin_smoothing);
  [[nodiscard]] int bin_of(double deviation) const;

  std::vector<double> bin_edges_;    ///< [47] ascending
  std::vector<double> bin_centres_;  ///< [48] mean deviation of each
  std::vector<double> paid_;         ///< [phase][bin] mean paid deviation
  std::vector<float> transition_;    ///< [phase][bin][next bin]
};

}  // namespace bess
