// DQN: squared temporal-difference error towards a target network [Paper, Eq. 6, 7; Mnih 2015].
// Network output: one value per action, in units of 1e4 EUR/h.
#pragma once

#include "workstation/rl/transition.h"

namespace bess {

struct DqnTile {
  MlpTile online, target;
  Matrix q_next;  ///< [actions x samples]
  Matrix q;       ///< [1 x samples] taken action's value, then dL/dq
};

/// Adds to `gradient` (of the mean over the batch) and returns the summed loss 0.5 (q - y)^2 with
///   y = r + gamma max_a' q_target(s', a')   (no bootstrap when terminal)
/// for samples first .. first+count-1, all of `action`.
double dqn_tile_gradient(float gamma, const ConstMlp& online, const ConstMlp& target,
                         const MiniBatch& batch, int action, Eigen::Index first, Eigen::Index count,
                         DqnTile& tile, MutableMlp& gradient);

}  // namespace bess
