#include "workstation/correction/correction_layer.h"

#include <algorithm>

#include "shared/action.h"

namespace bess {
namespace {
constexpr int kDis = static_cast<int>(Action::kDischarge);
constexpr int kIdle = static_cast<int>(Action::kIdle);
constexpr int kCha = static_cast<int>(Action::kCharge);
}  // namespace

CorrectionLayer::CorrectionLayer(const CorrectionOptions& options, int prices, int socs)
    : options_(options),
      prices_(prices),
      socs_(socs),
      projection_u_(prices, socs),
      projection_v_(prices, socs),
      u_(static_cast<std::size_t>(prices) * socs),
      v_(u_.size()),
      shifted_(u_.size()) {}

/// Bounds on x = difference + ramp. The ramp differs inside a row, so the row's strictest cell
/// counts.
RowBounds CorrectionLayer::bounds_of(const LatticeAxes& axes, double lower, double upper) const {
  const auto& price = axes.price_eur_per_mwh;
  RowBounds bounds;
  bounds.lower_rows = static_cast<int>(
      std::ranges::upper_bound(price, options_.thresholds.low_eur_per_mwh) - price.begin());
  bounds.upper_rows = static_cast<int>(
      price.end() - std::ranges::lower_bound(price, options_.thresholds.high_eur_per_mwh));
  const double low_ramp =
      bounds.lower_rows > 0 ? options_.price_slope * axes.mapped_price[bounds.lower_rows - 1] : 0;
  const double high_ramp =
      bounds.upper_rows > 0 ? options_.price_slope * axes.mapped_price[prices_ - bounds.upper_rows]
                            : 0;
  bounds.lower = lower + low_ramp + options_.soc_slope * axes.soc.back();
  bounds.upper = upper + high_ramp + options_.soc_slope * axes.soc.front();
  // Opposite ends must not cross: a lower bound below the upper one would let rows in between rise.
  bounds.lower = std::max(bounds.lower, bounds.upper + 1e-6);
  return bounds;
}

void CorrectionLayer::project(const LatticeAxes& axes, IsotonicProjection& projection,
                              const RowBounds& bounds, std::vector<double>& difference) {
  const auto ramp = [&](int i, int j) {
    return options_.price_slope * axes.mapped_price[i] + options_.soc_slope * axes.soc[j];
  };
  for (int i = 0; i < prices_; ++i) {
    for (int j = 0; j < socs_; ++j) {
      shifted_[i * socs_ + j] = difference[i * socs_ + j] + ramp(i, j);
    }
  }
  projection.project(shifted_, bounds, difference);
  for (int i = 0; i < prices_; ++i) {
    for (int j = 0; j < socs_; ++j) difference[i * socs_ + j] -= ramp(i, j);
  }
}

void CorrectionLayer::forward(const LatticeAxes& axes, const Eigen::MatrixXd& logits,
                              Eigen::MatrixXd& corrected) {
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    u_[c] = logits(kCha, c) - logits(kIdle, c);
    v_[c] = logits(kIdle, c) - logits(kDis, c);
  }
  project(axes, projection_u_, bounds_of(axes, options_.logit_margin, 0.0), u_);
  project(axes, projection_v_, bounds_of(axes, 0.0, -options_.logit_margin), v_);
  corrected.resize(kActionCount, logits.cols());
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    const double mean = logits.col(c).mean();
    corrected(kDis, c) = mean - (2 * v_[c] + u_[c]) / 3;
    corrected(kIdle, c) = corrected(kDis, c) + v_[c];
    corrected(kCha, c) = corrected(kIdle, c) + u_[c];
  }
}

void CorrectionLayer::backward(const Eigen::MatrixXd& gradient_corrected,
                               Eigen::MatrixXd& gradient_logits) {
  // z = mean + A (u, v): z_dis = mean - (2v+u)/3, z_idle = mean + (v-u)/3, z_cha = mean + (v+2u)/3.
  const auto& g = gradient_corrected;
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    u_[c] = (-g(kDis, c) - g(kIdle, c) + 2 * g(kCha, c)) / 3;
    v_[c] = (-2 * g(kDis, c) + g(kIdle, c) + g(kCha, c)) / 3;
  }
  projection_u_.backward(u_, u_);
  projection_v_.backward(v_, v_);
  gradient_logits.resize(kActionCount, g.cols());
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    const double mean = g.col(c).mean();  // d mean / d z' = 1/3 each, dL/d mean = sum of g
    gradient_logits(kDis, c) = mean - v_[c];
    gradient_logits(kIdle, c) = mean + v_[c] - u_[c];
    gradient_logits(kCha, c) = mean + u_[c];
  }
}

}  // namespace bess
