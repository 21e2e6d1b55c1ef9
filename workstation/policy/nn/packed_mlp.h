// Packed network of the gradient step: weights packed for the tile kernels, the activations of one
// tile, gradients in the kernels' layout. The head is divided into groups of outputs (one per
// action): a sample passes forward and backward through one group only.
#pragma once

#include <vector>

#include "workstation/policy/nn/tile_kernels.h"

namespace bess {

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
