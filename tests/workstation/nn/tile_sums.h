// A minibatch taken tile by tile by hand, as the learner does it, for small networks.
#pragma once

#include "workstation/rl/gradient_tile.h"

namespace bess {

/// Online and target network, packed for a gradient step.
struct PackedPair {
  PackedMlp online, target;

  PackedPair(const MlpShape& shape, const Parameters& online_parameters,
             const Parameters& target_parameters) {
    online.pack(ConstMlp(shape, online_parameters.data()), kActionCount,
                PackedMlp::Use::kForwardAndBackward);
    target.pack(ConstMlp(shape, target_parameters.data()), 1, PackedMlp::Use::kForward);
  }
  [[nodiscard]] GradientStep step(const TileKernels& kernels, const MiniBatch& batch,
                                  double gamma) const {
    return {kernels, online, target, batch, static_cast<float>(gamma)};
  }
};

struct LossAndGradient {
  double loss;  ///< summed over samples
  Parameters gradient;
};

/// Sums tile_gradient(range, gradient) over tiles of at most `tile_samples`.
template <typename TileGradient>
LossAndGradient sum_of_tiles(const MlpShape& shape, const MiniBatch& batch,
                             Eigen::Index tile_samples, const TileGradient& tile_gradient) {
  LossAndGradient result{0, Parameters::Zero(shape.parameter_count())};
  PackedGradient sum;
  sum.set_zero(shape, kActionCount);
  for (int action = 0; action < kActionCount; ++action) {
    const Eigen::Index end = batch.group_end[action];
    for (Eigen::Index at = batch.group_begin(action); at < end; at += tile_samples) {
      result.loss += tile_gradient(TileRange{action, at, std::min(tile_samples, end - at)}, sum);
    }
  }
  MutableMlp gradient(shape, result.gradient.data());
  sum.add_to(gradient);
  return result;
}

}  // namespace bess
