#include "workstation/rl/c51.h"

namespace bess {

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
void project_targets(const GradientStep& step, const TileRange& range, C51Tile& tile) {
  forward_hidden(step.kernels, step.target,
                 step.batch.next_state.middleCols(range.first, range.count), tile.net);
  forward_head(step.kernels, step.target, 0, tile.net, tile.z_next);
  const int count = tile.support.count;
  tile.m.resize(count, range.count);
  for (Eigen::Index n = 0; n < range.count; ++n) {
    const float* advantage = step.batch.next_advantage.col(range.first + n).data();
    float value[kActionCount];
    float sum[kActionCount];
    for (int a = 0; a < kActionCount; ++a) {
      float* p = tile.next.distribution(a);
      sum[a] = step.kernels.exponentials(tile.z_next.sample(n) + a * count, count, p).sum;
      value[a] = tile.atoms.dot(Eigen::Map<const Eigen::VectorXf>(p, tile.atoms.size())) / sum[a] +
                 advantage[a];
    }
    const auto best = static_cast<int>(argmax_action(value));
    const bool terminal = step.batch.terminal[static_cast<std::size_t>(range.first + n)] != 0;
    const float discount = terminal ? 0.0F : step.gamma;
    float* m = tile.m.sample(n);
    tile.next.project(best, 1 / sum[best],
                      step.batch.reward[range.first + n] + discount * advantage[best], discount, m);
    tile.edge_mass += m[0] + m[count - 1];
  }
}

/// Loss between tile.m and the online logits tile.z, summed; tile.z becomes its gradient
///   p_i - m_i + w (E_p[z] - E_m[z]) p_i (z_i - E_p[z]).
double distribution_loss(const GradientStep& step, C51Tile& tile, Eigen::Index samples) {
  const float weight = 1 / static_cast<float>(step.batch.size());
  double loss = 0;
  tile.sums.resize(samples);
  for (Eigen::Index n = 0; n < samples; ++n) {
    auto z = tile.z.all().col(n);
    const auto m = tile.m.all().col(n);
    // log p = z - max z - log sum, so the loss needs no logarithm of a small probability.
    const float weighted = m.dot(z);
    const SoftmaxSums sums = step.kernels.exponentials(z.data(), tile.support.count, z.data());
    loss += sums.largest - weighted;
    tile.sums[n] = sums.sum;
    z *= weight / sums.sum;
    if (step.mean_weight > 0) {
      const float mean = tile.atoms.dot(z) / weight;
      const float error = mean - tile.atoms.dot(m);
      loss += 0.5 * double{step.mean_weight} * double{error} * double{error};
      z.array() *= 1 + step.mean_weight * error * (tile.atoms.array() - mean);
    }
    z -= m * weight;
  }
  return loss + static_cast<double>(tile.sums.log().sum());
}

}  // namespace

double c51_tile_gradient(const GradientStep& step, const TileRange& range, C51Tile& tile,
                         PackedGradient& gradient) {
  project_targets(step, range, tile);
  const auto x = step.batch.state.middleCols(range.first, range.count);
  forward_hidden(step.kernels, step.online, x, tile.net);
  forward_head(step.kernels, step.online, range.action, tile.net, tile.z);
  const double loss = distribution_loss(step, tile, range.count);
  backward(step.kernels, step.online, range.action, x, tile.z.rows(tile.support.count), tile.net,
           gradient);
  return loss;
}

}  // namespace bess
