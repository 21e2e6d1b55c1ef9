#include "workstation/rl/c51.h"

#include <algorithm>
#include <cmath>

namespace bess {

void project_distribution(const Support& support, const float* probability, float reward,
                          float discount, float* projected) {
  const float inverse_step = 1 / support.step();
  std::fill_n(projected, support.count, 0.0F);
  for (int j = 0; j < support.count; ++j) {
    const float moved =
        std::clamp(reward + discount * support.atom(j), support.v_min, support.v_max);
    const float b = std::clamp((moved - support.v_min) * inverse_step, 0.0F,
                               static_cast<float>(support.count - 1));
    const int lower = std::min(static_cast<int>(b), support.count - 2);
    const float upper_share = b - static_cast<float>(lower);
    projected[lower] += probability[j] * (1 - upper_share);
    projected[lower + 1] += probability[j] * upper_share;
  }
}

void softmax_columns(Matrix& z) {
  z.rowwise() -= z.colwise().maxCoeff().eval();
  z = z.array().exp();
  z.array().rowwise() /= z.colwise().sum().array().eval();
}

Matrix mean_values(const Support& support, const MatrixRef& logits) {
  Matrix p = logits.reshaped(support.count, logits.size() / support.count);
  softmax_columns(p);
  const Eigen::RowVectorXf means = support.atoms().transpose() * p;
  return means.reshaped(kActionCount, logits.cols());
}

namespace {

/// Projected distribution of each sample's greedy next action -> tile.m.
void project_targets(const Support& support, float gamma, const MiniBatch& batch,
                     Eigen::Index first, C51Tile& tile) {
  const Eigen::Index count = tile.z_next.cols();
  tile.z_next.resize(support.count, count * kActionCount);  // same memory, one column per action
  softmax_columns(tile.z_next);
  const Eigen::RowVectorXf means = support.atoms().transpose() * tile.z_next;
  tile.m.resize(support.count, count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto sample = static_cast<std::size_t>(first + n);
    const Action best = argmax_action(means.data() + n * kActionCount);
    const float* probability = tile.z_next.col(n * kActionCount + static_cast<int>(best)).data();
    const float discount = batch.terminal[sample] != 0 ? 0.0F : gamma;
    project_distribution(support, probability, batch.reward[first + n], discount,
                         tile.m.col(n).data());
    tile.edge_mass += tile.m(0, n) + tile.m(support.count - 1, n);
  }
}

}  // namespace

double c51_tile_gradient(const Support& support, float gamma, const ConstMlp& online,
                         const ConstMlp& target, const MiniBatch& batch, int action,
                         Eigen::Index first, Eigen::Index count, C51Tile& tile,
                         MutableMlp& gradient) {
  forward_hidden(target, batch.next_state.middleCols(first, count), tile.target);
  forward_head(target, tile.target, tile.z_next);
  project_targets(support, gamma, batch, first, tile);

  const auto x = batch.state.middleCols(first, count);
  const auto w3 = online.w3.middleRows(action * support.count, support.count);
  forward_hidden(online, x, tile.online);
  tile.z.noalias() = w3 * tile.online.h2;
  tile.z.colwise() += online.b3.segment(action * support.count, support.count);
  tile.z.rowwise() -= tile.z.colwise().maxCoeff().eval();
  // log p = z - log sum exp z, so the loss needs no logarithm of a small probability.
  const double weighted = (tile.m.array() * tile.z.array()).sum();
  tile.z = tile.z.array().exp();
  const Eigen::RowVectorXf sums = tile.z.colwise().sum();
  const Eigen::RowVectorXf masses = tile.m.colwise().sum();
  const double loss = (masses.array() * sums.array().log()).cast<double>().sum() - weighted;
  tile.z.array().rowwise() *= (masses.array() / sums.array()).eval();
  tile.z = (tile.z - tile.m) / static_cast<float>(batch.size());

  gradient.w3.middleRows(action * support.count, support.count).noalias() +=
      tile.z * tile.online.h2.transpose();
  gradient.b3.segment(action * support.count, support.count) += tile.z.rowwise().sum();
  tile.online.dh2.noalias() = w3.transpose() * tile.z;
  backward_hidden(online, x, tile.online, gradient);
  return loss;
}

}  // namespace bess
