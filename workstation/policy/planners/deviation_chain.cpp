#include "workstation/policy/planners/stochastic_program.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

constexpr int kSmoothedBins = 3;  ///< reach of the smoothing, on both sides

/// Weight of a neighbour in a smoothed mean: Gaussian, not normalised; `sigma` in the same steps as
/// `distance`, 0: no smoothing.
double smoothing_kernel(int distance, double sigma) {
  if (sigma <= 0) return distance == 0 ? 1.0 : 0.0;
  return std::exp(-0.5 * distance * distance / (sigma * sigma));
}

}  // namespace

DeviationChain::DeviationChain(const std::vector<Sample>& samples, double bin_smoothing) {
  fit_bins(samples);
  count(samples, bin_smoothing);
}

void DeviationChain::save(BinaryWriter& out) const {
  out.put_list(bin_edges_);
  out.put_list(bin_centres_);
  out.put_list(paid_);
  out.put_list(transition_);
}

DeviationChain::DeviationChain(BinaryReader& in) {
  bin_edges_ = in.take_list<double>();
  bin_centres_ = in.take_list<double>();
  paid_ = in.take_list<double>();
  transition_ = in.take_list<float>();
  if (bin_edges_.size() != kBins - 1 || bin_centres_.size() != kBins ||
      paid_.size() != kPhases * kBins || transition_.size() != kPhases * kBins * kBins) {
    in.damaged("has a stochastic program of another size");
  }
}

int DeviationChain::bin_of(double deviation) const {
  return static_cast<int>(std::ranges::lower_bound(bin_edges_, deviation) - bin_edges_.begin());
}

DeviationChain::BinPosition DeviationChain::between(double deviation) const {
  const auto upper = std::ranges::upper_bound(bin_centres_, deviation) - bin_centres_.begin();
  const int lower = std::clamp(static_cast<int>(upper) - 1, 0, kBins - 2);
  const double width = bin_centres_[lower + 1] - bin_centres_[lower];
  const double weight = width > 0 ? (deviation - bin_centres_[lower]) / width : 0.0;
  return {lower, std::clamp(weight, 0.0, 1.0)};
}

void DeviationChain::fit_bins(const std::vector<Sample>& samples) {
  std::vector<double> deviations;
  for (const Sample& sample : samples) deviations.push_back(sample.deviation);
  std::ranges::sort(deviations);
  const std::size_t n = deviations.size();
  for (int b = 0; b < kBins; ++b) {
    const std::size_t first = n * static_cast<std::size_t>(b) / kBins;
    const std::size_t end = std::max(first + 1, n * static_cast<std::size_t>(b + 1) / kBins);
    if (b > 0) bin_edges_.push_back(deviations[first]);
    double sum = 0;
    for (std::size_t i = first; i < end; ++i) sum += deviations[i];
    bin_centres_.push_back(sum / static_cast<double>(end - first));
  }
}

void DeviationChain::count(const std::vector<Sample>& samples, double bin_smoothing) {
  constexpr int kCells = kPhases * kBins;
  Eigen::MatrixXd next = Eigen::MatrixXd::Zero(kCells, kBins);
  Eigen::VectorXd paid = Eigen::VectorXd::Zero(kCells), visits = Eigen::VectorXd::Zero(kCells);
  int cell = -1;  // of the previous sample
  for (const Sample& sample : samples) {
    const int bin = bin_of(sample.deviation);
    if (cell >= 0 && sample.follows) next(cell, bin) += 1;
    cell = sample.phase * kBins + bin;
    visits[cell] += 1;
    paid[cell] += sample.paid_deviation;
  }
  paid_.assign(kCells, 0.0);
  transition_.assign(kCells * kBins, 0.0F);
  for (int phase = 0; phase < kPhases; ++phase) {
    for (int b = 0; b < kBins; ++b) {
      const int to = phase * kBins + b;
      Eigen::RowVectorXd smoothed = Eigen::RowVectorXd::Zero(kBins);
      double sum = 0, weight = 0;
      for (int d = -kSmoothedBins; d <= kSmoothedBins; ++d) {
        if (b + d < 0 || b + d >= kBins) continue;
        const double k = smoothing_kernel(d, bin_smoothing);
        smoothed += k * next.row(to + d);
        sum += k * paid[to + d];
        weight += k * visits[to + d];
      }
      const double total = smoothed.sum();
      if (total <= 0) smoothed[b] = 1;  // never observed: stays in its bin
      paid_[to] = weight > 0 ? sum / weight : bin_centres_[b];
      for (int n = 0; n < kBins; ++n) {
        transition_[to * kBins + n] = static_cast<float>(smoothed[n] / std::max(total, 1.0));
      }
    }
  }
}

double MeanByQuarterHour::weight() const {
  double all = 0;
  for (const double n : count) all += n;
  return all;
}

std::array<double, kQuarterHourCount> MeanByQuarterHour::smoothed(double sigma) const {
  constexpr int kReach = 24;  ///< quarter-hours, on both sides
  std::array<double, kQuarterHourCount> mean{};
  double all_sum = 0;
  for (const double s : sum) all_sum += s;
  for (int q = 0; q < kQuarterHourCount; ++q) {
    double weighted = 0, weight = 0;
    for (int d = -kReach; d <= kReach; ++d) {
      const double k = smoothing_kernel(d, sigma);
      const auto near = static_cast<std::size_t>((q + d + kQuarterHourCount) % kQuarterHourCount);
      weighted += k * sum[near];
      weight += k * count[near];
    }
    mean[static_cast<std::size_t>(q)] = weight > 0 ? weighted / weight : all_sum / this->weight();
  }
  return mean;
}

PriceLevels fit_levels(const MarketSteps& market, const std::vector<MarketDay>& days,
                       int level_count) {
  constexpr double kReach = 3;  ///< standard deviations
  double sum = 0, squares = 0, count = 0;
  for_each_step(market, days, [&](const MarketStep& step) {
    sum += step.level_eur_per_mwh();
    squares += step.level_eur_per_mwh() * step.level_eur_per_mwh();
    count += 1;
  });
  const double mean = sum / count;
  const double mean_square = squares / count;
  const double deviation = std::sqrt(std::max(0.0, mean_square - mean * mean));
  std::vector<double> levels;
  const int last = level_count - 1;
  for (int i = 0; i <= last; ++i) {
    levels.push_back(mean + (2.0 * i / last - 1) * kReach * std::max(1.0, deviation));
  }
  return {mean, std::move(levels)};
}

DeviationChain::BinPosition between_levels(const std::vector<double>& levels, double level) {
  const auto count = static_cast<int>(levels.size());
  if (count == 1) return {0, 0};
  const double step = levels[1] - levels[0];
  const double x = std::clamp((level - levels[0]) / step, 0.0, count - 1.0);
  const int lower = std::min(static_cast<int>(x), count - 2);
  return {lower, x - lower};
}

}  // namespace bess
