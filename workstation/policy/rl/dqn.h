// DQN: squared temporal-difference error towards a target network [Paper, Eq. 6, 7; Mnih 2015].
// Network output: one value per action, in units of 1e4 EUR/h.
#pragma once

#include "workstation/policy/rl/c51.h"

namespace bess {

/// Workspace of one thread.
struct DqnTile {
  MlpActivations net;  ///< of the target network first, then of the online network
  TileMatrix q_next;   ///< [actions x samples]
  TileMatrix q;        ///< [1 x samples] taken action's value, then dL/dq
};

/// Adds to `gradient` (of the mean over the minibatch) and returns the summed loss 0.5 (q - y)^2,
///   y = r + gamma max_a' q_target(s', a')   (no bootstrap when terminal)
double dqn_tile_gradient(const GradientStep& step, const TileRange& range, DqnTile& tile,
                         PackedGradient& gradient);

}  // namespace bess
