// C51, categorical distributional Q-learning [Bellemare, Dabney, Munos 2017, Algorithm 1; Paper,
// Eq. 8-10]. Network output: kActionCount x atoms logits, atom index fastest. Values in units of
// 1e4 EUR/h.
#pragma once

#include "workstation/rl/gradient_tile.h"
#include "workstation/rl/projection.h"
#include "workstation/rl/support.h"

namespace bess {

/// Softmax of each column in place.
void softmax_columns(Matrix& z);

/// Means of the value distributions, [actions x samples], from logits [actions*atoms x samples].
Matrix mean_values(const Support& support, const MatrixRef& logits);

/// Working space of one thread for tile after tile.
struct C51Tile {
  explicit C51Tile(const Support& s)
      : support(s), next(s, kActionCount), atoms(Eigen::VectorXf::Zero(padded_to_panels(s.count))) {
    atoms.head(s.count) = s.atoms();
  }

  Support support;
  CategoricalProjection next;  ///< the next state's distributions, one row an action
  Eigen::VectorXf atoms;       ///< z_i, padded with zeros
  MlpActivations net;          ///< of the target network first, then of the online network
  TileMatrix z_next;           ///< [actions*atoms x samples] logits of the target network
  TileMatrix m;                ///< [atoms x samples] projected target distribution
  TileMatrix z;                ///< [atoms x samples] logits of the action taken, then dL/dz
  Eigen::ArrayXf sums;         ///< [samples] of exponentials
  double edge_mass = 0;        ///< target mass on the two end atoms, summed over samples
};

/// Adds to `gradient` (of the mean over the minibatch) and returns the summed cross-entropy
///   -sum_i m_i log p_i(s, a)   [Paper, Eq. 8 up to the entropy of m]
/// and, with w = step.mean_weight, w / 2 (E_p[z] - E_m[z])^2: decisions hang on differences of
/// means of a percent of the support, which the cross-entropy alone learns late. Next actions are
/// greedy by mean under the target network, ties to the lowest action.
double c51_tile_gradient(const GradientStep& step, const TileRange& range, C51Tile& tile,
                         PackedGradient& gradient);

}  // namespace bess
