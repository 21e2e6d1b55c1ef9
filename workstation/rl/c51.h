// C51, categorical distributional Q-learning [Bellemare, Dabney, Munos 2017, Algorithm 1; Paper,
// Eq. 8-10]. Network output: kActionCount x atoms logits, atom index fastest. Values in units of
// 1e4 EUR/h.
#pragma once

#include <vector>

#include "workstation/rl/transition.h"

namespace bess {

/// The atoms z_i = v_min + i * step, i = 0 .. count-1 [Paper, Eq. 10].
struct Support {
  float v_min;
  float v_max;
  int count;
  [[nodiscard]] float step() const { return (v_max - v_min) / static_cast<float>(count - 1); }
  [[nodiscard]] float atom(int i) const { return v_min + static_cast<float>(i) * step(); }
  [[nodiscard]] Eigen::VectorXf atoms() const {
    return Eigen::VectorXf::LinSpaced(count, v_min, v_max);
  }
};

/// Projects the distribution `probability` over the atoms moved to reward + discount * z back onto
/// the support [Bellemare 2017, Eq. 7]; `projected` gets the mass, which sums to that of
/// `probability`.
///   Tz_j = clip(r + gamma z_j, v_min, v_max)   b_j = (Tz_j - v_min) / step
///   m_l += p_j (u - b_j),  m_u += p_j (b_j - l)   with l = floor(b_j), u = l + 1
void project_distribution(const Support& support, const float* probability, float reward,
                          float discount, float* projected);

/// Softmax of each column in place.
void softmax_columns(Matrix& z);

/// Means of the value distributions, [actions x samples], from logits [actions*atoms x samples].
Matrix mean_values(const Support& support, const MatrixRef& logits);

/// Loss and gradient of one tile of a minibatch: samples first .. first+count-1, all of one action.
struct C51Tile {
  MlpTile online, target;
  Matrix z_next;  ///< [actions*atoms x samples] logits, then probabilities, of the target network
  Matrix m;       ///< [atoms x samples] projected target distribution
  Matrix z;       ///< [atoms x samples] logits, then probabilities minus m
  double edge_mass = 0;  ///< target mass on the two end atoms, summed over samples
};

/// Adds to `gradient` (of the mean over `batch_size`) and returns the summed cross-entropy
///   -sum_i m_i log p_i(s, a)   [Paper, Eq. 8 up to the entropy of m]
/// Next actions are greedy by mean under the target network, ties to the lowest action.
double c51_tile_gradient(const Support& support, float gamma, const ConstMlp& online,
                         const ConstMlp& target, const MiniBatch& batch, int action,
                         Eigen::Index first, Eigen::Index count, C51Tile& tile,
                         MutableMlp& gradient);

}  // namespace bess
