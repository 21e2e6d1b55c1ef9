#include "workstation/policy/rl/c51.h"

#include <algorithm>
#include <cmath>

#include "workstation/policy/nn/packed_mlp.h"

namespace bess {

CategoricalProjection::CategoricalProjection(const Support& support, int rows)
    : support_(support),
      padded_(padded_to_panels(support.count)),
      margin_(padded_),
      index_(Eigen::ArrayXf::LinSpaced(padded_, 0.0F, static_cast<float>(padded_ - 1))),
      rows_(Eigen::MatrixXf::Zero(padded_ + 2 * margin_, rows)) {}

void CategoricalProjection::project(int row, float scale, float reward, float discount,
                                    float* m) const {
  const int last = support_.count - 1;
  const float* p = rows_.col(row).data() + margin_;
  const Eigen::Map<const Eigen::ArrayXf> here(p, padded_);
  Eigen::Map<Eigen::ArrayXf> result(m, padded_);

  // Atom j moves by shift - shrink * j steps, the first furthest up.
  const double shrink = 1 - double{discount};
  const double shift = (double{reward} - shrink * double{support_.v_min}) / double{support_.step()};
  const double nearest = std::max(std::floor(shift - shrink * last), -double(last));
  const double furthest = std::min(std::floor(shift) + 1, double(last));
  const auto slope = static_cast<float>(shrink);

  result.setZero();
  const auto count = static_cast<int>(std::max(0.0, furthest - nearest + 1));
  for (int n = 0; n < count; ++n) {  // b_j - i = shift - d - shrink (i - d)
    const double d = nearest + n;
    const Eigen::Map<const Eigen::ArrayXf> moved(p - static_cast<Eigen::Index>(d), padded_);
    const auto offset = static_cast<float>(shift - d + shrink * d);
    result += moved * (1 - (offset - slope * index_).abs()).max(0.0F);
  }
  result *= scale;
  // The end atoms also receive the probability beyond them.
  const auto moves = static_cast<float>(shift) - slope * index_;
  const float low = (here * ((1 - index_) - moves).max(0.0F).min(1.0F)).sum();
  const float high =
      (here * ((index_ - static_cast<float>(last - 1)) + moves).max(0.0F).min(1.0F)).sum();
  result.tail(padded_ - support_.count).setZero();
  m[0] = scale * low;
  m[last] = scale * high;
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
void project_targets(const GradientStep& step, const TileRange& range, C51Tile& tile) {
  forward_hidden(step.target, step.batch.next_state.middleCols(range.first, range.count), tile.net);
  forward_head(step.target, 0, tile.net, tile.z_next);
  const int count = tile.support.count;
  tile.m.resize(count, range.count);
  for (Eigen::Index n = 0; n < range.count; ++n) {
    const float* advantage = step.batch.next_advantage.col(range.first + n).data();
    float value[kActionCount];
    float sum[kActionCount];
    for (int a = 0; a < kActionCount; ++a) {
      float* p = tile.next.distribution(a);
      sum[a] = kernels::exponentials(tile.z_next.sample(n) + a * count, count, p).sum;
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
    const SoftmaxSums sums = kernels::exponentials(z.data(), tile.support.count, z.data());
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
  forward_hidden(step.online, x, tile.net);
  forward_head(step.online, range.action, tile.net, tile.z);
  const double loss = distribution_loss(step, tile, range.count);
  backward(step.online, range.action, x, tile.z.rows(tile.support.count), tile.net, gradient);
  return loss;
}

}  // namespace bess
