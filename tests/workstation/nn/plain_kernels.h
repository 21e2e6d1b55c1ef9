// The twin of packet_kernels.cpp in plain Eigen expressions: the same functions, the same layouts,
// panel by panel.
#pragma once

#include "workstation/nn/tile_kernels.h"

namespace bess {
namespace plain {

using Eigen::Index;

inline Eigen::Map<const Matrix> panel_of(const Panels& w, Index p) {
  return {w.panel(p), kPanelLanes, w.depth()};
}

inline void affine(const MatrixRef& x, const Panels& w, const float* bias, Activation activation,
                   MatrixOut y) {
  for (Index p = 0; p < w.count(); ++p) {
    y.middleRows(p * kPanelLanes, kPanelLanes).noalias() = panel_of(w, p) * x;
  }
  y.colwise() += Eigen::Map<const Eigen::VectorXf>(bias, y.rows());
  if (activation == Activation::kRelu) y = y.cwiseMax(0.0F);
}

inline void backward(const MatrixRef& dy, const Panels& w, const MatrixRef& h, MatrixOut dh,
                     float* db) {
  for (Index p = 0; p < w.count(); ++p) {
    dh.middleRows(p * kPanelLanes, kPanelLanes).noalias() = panel_of(w, p) * dy;
  }
  dh = (h.array() > 0.0F).select(dh, 0.0F);
  Eigen::Map<Eigen::VectorXf>(db, dh.rows()) += dh.rowwise().sum();
}

inline void backward_to_inputs(const MatrixRef& dy, const Panels& w, const MatrixRef& h,
                               const MatrixRef& x, MatrixOut dw, float* db) {
  Matrix dh(w.padded_lanes(), dy.cols());
  backward(dy, w, h, dh, db);
  dw.noalias() += dh * x.transpose();
}

inline void add_outer_products(const MatrixRef& lanes, const MatrixRef& rows, MatrixOut dw) {
  dw.noalias() += lanes * rows.transpose();
}

inline SoftmaxSums exponentials(const float* z, Index count, float* e) {
  const Eigen::Map<const Eigen::ArrayXf> logits(z, count);
  Eigen::Map<Eigen::ArrayXf> result(e, padded_to_panels(count));
  const float largest = logits.maxCoeff();
  result.head(count) = (logits - largest).exp();
  result.tail(result.size() - count).setZero();
  return {largest, result.head(count).sum()};
}

}  // namespace plain

inline const TileKernels& plain_kernels() {
  static constexpr TileKernels kernels{"plain",
                                       plain::affine,
                                       plain::backward,
                                       plain::backward_to_inputs,
                                       plain::add_outer_products,
                                       plain::exponentials};
  return kernels;
}

}  // namespace bess
