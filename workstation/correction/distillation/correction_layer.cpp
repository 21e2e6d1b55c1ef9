#include "workstation/correction/distillation/correction_layer.h"

#include <algorithm>

#include "workstation/correction/distillation/constraint_layer.h"

namespace bess {

RowBounds ramped_bounds(const CorrectionOptions& options, const LatticeAxes& axes, double lower,
                        double upper) {
  const auto& price = axes.price_eur_per_mwh;
  RowBounds bounds;
  bounds.lower_rows = static_cast<int>(
      std::ranges::upper_bound(price, options.thresholds.low_eur_per_mwh) - price.begin());
  bounds.upper_rows = static_cast<int>(
      price.end() - std::ranges::lower_bound(price, options.thresholds.high_eur_per_mwh));
  const double low_ramp =
      bounds.lower_rows > 0 ? options.price_slope * axes.mapped_price[bounds.lower_rows - 1] : 0;
  const double high_ramp =
      bounds.upper_rows > 0 ? options.price_slope * axes.mapped_price.end()[-bounds.upper_rows] : 0;
  bounds.lower = lower + low_ramp + options.soc_slope * axes.soc.back();
  bounds.upper = upper + high_ramp + options.soc_slope * axes.soc.front();
  // Opposite ends must not cross: a lower bound below the upper one would let rows in between rise.
  bounds.lower = std::max(bounds.lower, bounds.upper + 1e-6);
  return bounds;
}

CorrectionLayer::CorrectionLayer(const CorrectionOptions& options, int prices, int socs)
    : options_(options),
      prices_(prices),
      socs_(socs),
      projection_u_(prices, socs),
      projection_v_(prices, socs),
      u_(static_cast<std::size_t>(prices) * socs),
      v_(u_.size()),
      shifted_(u_.size()) {}

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
    const LogitDifferences difference = differences_of(logits, c);
    u_[c] = difference.u;
    v_[c] = difference.v;
  }
  project(axes, projection_u_, ramped_bounds(options_, axes, options_.logit_margin, 0.0), u_);
  project(axes, projection_v_, ramped_bounds(options_, axes, 0.0, -options_.logit_margin), v_);
  corrected.resize(kActionCount, logits.cols());
  for (Eigen::Index c = 0; c < logits.cols(); ++c) {
    set_logits(logits.col(c).mean(), {u_[c], v_[c]}, corrected, c);
  }
}

void CorrectionLayer::backward(const Eigen::MatrixXd& gradient_corrected,
                               Eigen::MatrixXd& gradient_logits) {
  const auto& g = gradient_corrected;
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    const LogitDifferences difference = difference_gradient_of(g, c);
    u_[c] = difference.u;
    v_[c] = difference.v;
  }
  projection_u_.backward(u_, u_);
  projection_v_.backward(v_, v_);
  gradient_logits.resize(kActionCount, g.cols());
  for (Eigen::Index c = 0; c < g.cols(); ++c) {
    set_logit_gradient(g, {u_[c], v_[c]}, gradient_logits, c);
  }
}

}  // namespace bess
