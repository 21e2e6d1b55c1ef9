// What the tiles of one gradient step share, whichever the method.
#pragma once

#include "workstation/nn/packed_mlp.h"
#include "workstation/rl/transition.h"

namespace bess {

struct GradientStep {
  const TileKernels& kernels;
  const PackedMlp& online;  ///< head in one group an action
  const PackedMlp& target;  ///< head in one group
  const MiniBatch& batch;
  float gamma;
  float mean_weight = 0;  ///< C51 only
};

/// Samples first .. first+count-1 of the minibatch, all of one action.
struct TileRange {
  int action;
  Eigen::Index first;
  Eigen::Index count;
};

}  // namespace bess
