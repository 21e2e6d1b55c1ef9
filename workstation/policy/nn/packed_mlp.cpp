#include "workstation/policy/nn/packed_mlp.h"

namespace bess {
namespace {

Eigen::VectorXf padded(const Eigen::Ref<const Eigen::VectorXf>& values) {
  Eigen::VectorXf result = Eigen::VectorXf::Zero(padded_to_panels(values.size()));
  result.head(values.size()) = values;
  return result;
}

}  // namespace

void PackedMlp::pack(const ConstMlp& mlp, int groups, Use use) {
  const bool back = use == Use::kForwardAndBackward;
  w1.pack(mlp.w1);
  w2.pack(mlp.w2);
  if (back) w2_back.pack(mlp.w2.transpose());
  b1 = padded(mlp.b1);
  b2 = padded(mlp.b2);
  heads.resize(static_cast<std::size_t>(groups));
  const Eigen::Index outputs = mlp.w3.rows() / groups;
  Eigen::Index first = 0;
  for (Head& head : heads) {
    const auto w = mlp.w3.middleRows(first, outputs);
    head.w.pack(w);
    if (back) head.w_back.pack(w.transpose());
    head.bias = padded(mlp.b3.segment(first, outputs));
    first += outputs;
  }
}

void PackedGradient::set_zero(const MlpShape& shape, int groups) {
  const Eigen::Index h1 = padded_to_panels(shape.hidden1);
  const Eigen::Index h2 = padded_to_panels(shape.hidden2);
  const Eigen::Index outputs = shape.outputs / groups;
  w1.setZero(h1, shape.inputs);
  b1.setZero(h1);
  w2.setZero(h2, shape.hidden1);
  b2.setZero(h2);
  heads.resize(static_cast<std::size_t>(groups));
  for (Head& head : heads) {
    head.w.setZero(h2, outputs);
    head.b.setZero(padded_to_panels(outputs));
  }
}

void PackedGradient::add_to(MutableMlp& gradient) const {
  gradient.w1 += w1.topRows(gradient.w1.rows());
  gradient.b1 += b1.head(gradient.b1.size());
  gradient.w2 += w2.topRows(gradient.w2.rows());
  gradient.b2 += b2.head(gradient.b2.size());
  Eigen::Index first = 0;
  for (const Head& head : heads) {
    const Eigen::Index outputs = head.w.cols();
    gradient.w3.middleRows(first, outputs) += head.w.topRows(gradient.w3.cols()).transpose();
    gradient.b3.segment(first, outputs) += head.b.head(outputs);
    first += outputs;
  }
}

void forward_hidden(const PackedMlp& net, const MatrixRef& x, MlpActivations& tile) {
  tile.h1.resize(net.w1.padded_lanes(), x.cols());
  tile.h2.resize(net.w2.padded_lanes(), x.cols());
  kernels::affine(x, net.w1, net.b1.data(), Activation::kRelu, tile.h1.all());
  kernels::affine(tile.h1.rows(net.w2.depth()), net.w2, net.b2.data(), Activation::kRelu,
                  tile.h2.all());
}

void forward_head(const PackedMlp& net, int group, MlpActivations& tile, TileMatrix& z) {
  const PackedMlp::Head& head = net.heads[static_cast<std::size_t>(group)];
  const auto h2 = tile.h2.rows(head.w.depth());
  z.resize(head.w.padded_lanes(), h2.cols());
  kernels::affine(h2, head.w, head.bias.data(), Activation::kLinear, z.all());
}

void backward(const PackedMlp& net, int group, const MatrixRef& x, const MatrixRef& dz,
              MlpActivations& tile, PackedGradient& gradient) {
  const PackedMlp::Head& head = net.heads[static_cast<std::size_t>(group)];
  PackedGradient::Head& head_gradient = gradient.heads[static_cast<std::size_t>(group)];
  head_gradient.b.head(dz.rows()) += dz.rowwise().sum();
  kernels::add_outer_products(tile.h2.all(), dz, head_gradient.w);
  tile.dh2.resize(head.w_back.padded_lanes(), x.cols());
  kernels::backward(dz, head.w_back, tile.h2.all(), tile.dh2.all(), gradient.b2.data());
  kernels::add_outer_products(tile.dh2.all(), tile.h1.rows(net.w2.depth()), gradient.w2);
  kernels::backward_to_inputs(tile.dh2.rows(net.w2_back.depth()), net.w2_back, tile.h1.all(), x,
                              gradient.w1, gradient.b1.data());
}

}  // namespace bess
