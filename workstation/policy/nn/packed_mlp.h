// Packed network of the gradient step: weights packed for the tile kernels, the activations of one
// tile, gradients in the kernels' layout. The head is divided into groups of outputs (one per
// action): a sample passes forward and backward through one group only.
#pragma once

#include <vector>

#include "workstation/policy/nn/mlp.h"

namespace bess {

// Tile kernels: the five loops that dominate a gradient step, over one tile of samples,
// register-blocked with vector packets (packet_kernels.cpp); tests compare them with plain Eigen.
// Samples are columns, features are contiguous; a matrix whose features run along vector lanes has
// its rows padded to whole panels.

/// Outputs computed in parallel: two vector registers.
inline constexpr int kPanelLanes = 2 * Eigen::internal::packet_traits<float>::size;

inline Eigen::Index padded_to_panels(Eigen::Index lanes) {
  return (lanes + kPanelLanes - 1) / kPanelLanes * kPanelLanes;
}

/// Weight matrix [lanes x depth] in the order of a product: [panel][depth][kPanelLanes], the last
/// panel padded with zeros. The largest panel, 256 deep, is 32 KiB with AVX-512 and stays in the
/// first-level cache during a tile.
class Panels {
 public:
  template <typename Derived>
  void pack(const Eigen::MatrixBase<Derived>& weights) {
    depth_ = weights.cols();
    count_ = padded_to_panels(weights.rows()) / kPanelLanes;
    values_.setZero(count_ * depth_ * kPanelLanes);
    for (Eigen::Index p = 0; p < count_; ++p) {
      const Eigen::Index lanes =
          std::min<Eigen::Index>(kPanelLanes, weights.rows() - p * kPanelLanes);
      Eigen::Map<Matrix>(values_.data() + p * depth_ * kPanelLanes, kPanelLanes, depth_)
          .topRows(lanes) = weights.middleRows(p * kPanelLanes, lanes);
    }
  }
  [[nodiscard]] Eigen::Index count() const { return count_; }
  [[nodiscard]] Eigen::Index depth() const { return depth_; }
  [[nodiscard]] Eigen::Index padded_lanes() const { return count_ * kPanelLanes; }
  [[nodiscard]] const float* panel(Eigen::Index p) const {
    return values_.data() + p * depth_ * kPanelLanes;
  }

 private:
  Eigen::Index count_ = 0;
  Eigen::Index depth_ = 0;
  Eigen::VectorXf values_;
};

using MatrixOut = Eigen::Ref<Matrix>;
enum class Activation { kLinear, kRelu };

/// Maximum of a row of logits, and the sum of their exponentials relative to it.
struct SoftmaxSums {
  float largest;
  float sum;
};

namespace kernels {

/// y = activation(W x + bias).
/// x [depth x samples], W [lanes x depth], bias [padded lanes], y [padded lanes x samples].
void affine(const MatrixRef& x, const Panels& w, const float* bias, Activation activation,
            MatrixOut y);

/// Backward through a layer and the preceding ReLU: dh = (W' dy) where h > 0, else 0; db += sum of
/// dh over samples. dy [depth x samples], W' [lanes x depth], h and dh [padded lanes x samples], db
/// [padded lanes].
void backward(const MatrixRef& dy, const Panels& w, const MatrixRef& h, MatrixOut dh, float* db);

/// As `backward`, for the layer next to the inputs: dh is used directly in dw += dh x^T and not
/// stored. x [inputs x samples], dw [padded lanes x inputs].
void backward_to_inputs(const MatrixRef& dy, const Panels& w, const MatrixRef& h,
                        const MatrixRef& x, MatrixOut dw, float* db);

/// dw += lanes rows^T, summed over samples. lanes [padded lanes x samples], rows [n x samples], dw
/// [padded lanes x n].
void add_outer_products(const MatrixRef& lanes, const MatrixRef& rows, MatrixOut dw);

/// e_i = exp(z_i - max z), i < count; zero up to the next multiple of kPanelLanes. z must be
/// readable up to there; e may be z. No alignment required.
SoftmaxSums exponentials(const float* z, Eigen::Index count, float* e);

}  // namespace kernels

/// Packed copy of a network's parameters; repack after each change of them.
struct PackedMlp {
  struct Head {
    Panels w;              ///< [group outputs x h2]
    Panels w_back;         ///< [h2 x group outputs]
    Eigen::VectorXf bias;  ///< padded
  };
  Panels w1, w2;           ///< [h1 x inputs], [h2 x h1]
  Panels w2_back;          ///< [h1 x h2]
  Eigen::VectorXf b1, b2;  ///< padded to whole panels, like every vector along lanes
  std::vector<Head> heads;

  enum class Use { kForward, kForwardAndBackward };
  /// `groups` divides the outputs.
  void pack(const ConstMlp& mlp, int groups, Use use);
};

/// dL/d parameters summed over tiles. Rows along lanes are padded with zeros.
struct PackedGradient {
  struct Head {
    Matrix w;           ///< [h2 x group outputs], transposed: h2 fills panels, 51 atoms do not
    Eigen::VectorXf b;  ///< padded
  };
  Matrix w1, w2;  ///< [h1 x inputs], [h2 x h1]
  Eigen::VectorXf b1, b2;
  std::vector<Head> heads;

  void set_zero(const MlpShape& shape, int groups);
  /// Adds everything to the gradient in the flat vector's layout.
  void add_to(MutableMlp& gradient) const;
};

/// Matrix of samples as columns that reuses its storage from tile to tile. The column stride is one
/// packet longer than the column: a stride of exactly 1 KiB would cause conflicts in the
/// first-level cache.
class TileMatrix {
 public:
  /// Rows padded to whole panels.
  void resize(Eigen::Index rows, Eigen::Index samples) {
    rows_ = padded_to_panels(rows);
    samples_ = samples;
    const Eigen::Index stride = rows_ + kPanelLanes / 2;
    if (storage_.rows() != stride || storage_.cols() < samples) storage_.setZero(stride, samples);
  }
  [[nodiscard]] auto all() { return storage_.topLeftCorner(rows_, samples_); }
  [[nodiscard]] auto rows(Eigen::Index count) { return storage_.topLeftCorner(count, samples_); }
  [[nodiscard]] float* sample(Eigen::Index n) { return storage_.col(n).data(); }

 private:
  Matrix storage_;
  Eigen::Index rows_ = 0;
  Eigen::Index samples_ = 0;
};

struct MlpActivations {
  TileMatrix h1, h2;  ///< [hidden x samples] after ReLU
  TileMatrix dh2;     ///< gradient before ReLU; that of h1 is never stored
};

/// h1 = relu(W1 x + b1), h2 = relu(W2 h1 + b2). x is [inputs x samples].
void forward_hidden(const PackedMlp& net, const MatrixRef& x, MlpActivations& tile);
/// z = W3 h2 + b3 for the outputs of one group. z becomes [padded group outputs x samples].
void forward_head(const PackedMlp& net, int group, MlpActivations& tile, TileMatrix& z);
/// Adds the gradient of all layers from dz = dL/dz [group outputs x samples] of one group.
void backward(const PackedMlp& net, int group, const MatrixRef& x, const MatrixRef& dz,
              MlpActivations& tile, PackedGradient& gradient);

}  // namespace bess
