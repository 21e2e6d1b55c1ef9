#include "workstation/nn/bf16_kernels.h"

#include "workstation/nn/bf16_products.h"

namespace bess {
namespace {

/// Below this depth a product is one with the inputs, and hardly costs anything.
constexpr Eigen::Index kDepthMin = 32;

bf16::Input view(const MatrixRef& m) { return {m.data(), m.rows(), m.cols(), m.outerStride()}; }
bf16::Output view(MatrixOut& m) { return {m.data(), m.rows(), m.cols(), m.outerStride()}; }
bf16::Weights view(const Panels& w) {
  return {w.panel(0), w.padded_lanes(), w.depth(), kPanelLanes};
}

template <bf16::Unit unit>
void affine(const MatrixRef& x, const Panels& w, const float* bias, Activation activation,
            MatrixOut y) {
  if (w.depth() < kDepthMin) return packet_kernels().affine(x, w, bias, activation, y);
  bf16::affine(unit, view(x), view(w), bias, activation == Activation::kRelu, view(y));
}

template <bf16::Unit unit>
void backward(const MatrixRef& dy, const Panels& w, const MatrixRef& h, MatrixOut dh, float* db) {
  bf16::backward(unit, view(dy), view(w), view(h), view(dh), db);
}

template <bf16::Unit unit>
void backward_to_inputs(const MatrixRef& dy, const Panels& w, const MatrixRef& h,
                        const MatrixRef& x, MatrixOut dw, float* db) {
  bf16::backward_to_inputs(unit, view(dy), view(w), view(h), view(x), view(dw), db);
}

template <bf16::Unit unit>
void add_outer_products(const MatrixRef& lanes, const MatrixRef& rows, MatrixOut dw) {
  bf16::add_outer_products(unit, view(lanes), view(rows), view(dw));
}

template <bf16::Unit unit>
const TileKernels& table(const char* name) {
  static const TileKernels kernels{name,
                                   affine<unit>,
                                   backward<unit>,
                                   backward_to_inputs<unit>,
                                   add_outer_products<unit>,
                                   packet_kernels().exponentials};
  return kernels;
}

}  // namespace

std::vector<const TileKernels*> bf16_kernels() {
  static const bf16::Unit best = bf16::best_unit();
  std::vector<const TileKernels*> there;
  if (best == bf16::Unit::kTiles) there.push_back(&table<bf16::Unit::kTiles>("bf16 tiles"));
  if (best != bf16::Unit::kNone) there.push_back(&table<bf16::Unit::kDotProducts>("bf16"));
  return there;
}

}  // namespace bess
