#include "workstation/policy/nn/mlp.h"

#include <cmath>

#include "workstation/base/random.h"

namespace bess {
namespace {

void fill_uniform(float* begin, Eigen::Index count, int fan_in, Random& random) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(fan_in));
  for (Eigen::Index i = 0; i < count; ++i) {
    begin[i] = static_cast<float>((2 * random.uniform() - 1) * bound);
  }
}

/// First layer: the kink of each unit passes through a random point of the inputs' unit cube.
/// PyTorch's default puts most kinks outside, which makes the initial network almost linear in
/// price and SoC.
void spread_kinks(MutableMlp& mlp, Random& random) {
  for (Eigen::Index i = 0; i < mlp.w1.rows(); ++i) {
    double at_point = 0;
    for (Eigen::Index j = 0; j < mlp.w1.cols(); ++j) {
      mlp.w1(i, j) = static_cast<float>(2 * random.uniform() - 1);
      at_point += mlp.w1(i, j) * random.uniform();
    }
    mlp.b1[i] = static_cast<float>(-at_point);
  }
}

}  // namespace

Parameters initial_parameters(const MlpShape& shape, std::uint64_t seed) {
  Parameters parameters(shape.parameter_count());
  MutableMlp mlp(shape, parameters.data());
  Random random(seed);
  spread_kinks(mlp, random);
  fill_uniform(mlp.w2.data(), mlp.w2.size() + mlp.b2.size(), shape.hidden1, random);
  fill_uniform(mlp.w3.data(), mlp.w3.size() + mlp.b3.size(), shape.hidden2, random);
  return parameters;
}

void forward_hidden(const ConstMlp& mlp, const MatrixRef& x, MlpTile& tile) {
  tile.h1.noalias() = mlp.w1 * x;
  tile.h1 = (tile.h1.colwise() + mlp.b1).cwiseMax(0.0F);
  tile.h2.noalias() = mlp.w2 * tile.h1;
  tile.h2 = (tile.h2.colwise() + mlp.b2).cwiseMax(0.0F);
}

void forward_head(const ConstMlp& mlp, const MlpTile& tile, Matrix& z) {
  z.noalias() = mlp.w3 * tile.h2;
  z.colwise() += mlp.b3;
}

void backward_head(const ConstMlp& mlp, const MatrixRef& dz, MlpTile& tile, MutableMlp& gradient) {
  gradient.w3.noalias() += dz * tile.h2.transpose();
  gradient.b3 += dz.rowwise().sum();
  tile.dh2.noalias() = mlp.w3.transpose() * dz;
}

void backward_hidden(const ConstMlp& mlp, const MatrixRef& x, MlpTile& tile, MutableMlp& gradient) {
  tile.dh2.array() *= (tile.h2.array() > 0.0F).cast<float>();
  gradient.w2.noalias() += tile.dh2 * tile.h1.transpose();
  gradient.b2 += tile.dh2.rowwise().sum();
  tile.dh1.noalias() = mlp.w2.transpose() * tile.dh2;
  tile.dh1.array() *= (tile.h1.array() > 0.0F).cast<float>();
  gradient.w1.noalias() += tile.dh1 * x.transpose();
  gradient.b1 += tile.dh1.rowwise().sum();
}

}  // namespace bess
