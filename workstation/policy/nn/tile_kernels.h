// Tile kernels: the five loops that dominate a gradient step, over one tile of samples,
// register-blocked with vector packets (packet_kernels.cpp); tests compare them with plain Eigen.
// Samples are columns, features are contiguous; a matrix whose features run along vector lanes has
// its rows padded to whole panels.
#pragma once

#include "workstation/policy/nn/mlp.h"

namespace bess {

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

}  // namespace bess
