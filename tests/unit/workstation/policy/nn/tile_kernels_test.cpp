// Packet kernels against products in double, over shapes that are not whole panels, blocks or
// packets.

#include "tests/unit/workstation/policy/nn/reference_net.h"
#include "workstation/policy/nn/packed_mlp.h"

namespace bess {
namespace {

struct Shape {
  int lanes, depth, samples;
};

std::ostream& operator<<(std::ostream& out, const Shape& s) {
  return out << s.lanes << "_lanes_" << s.depth << "_deep_" << s.samples << "_samples";
}

class Kernels : public testing::TestWithParam<Shape> {
 protected:
  const Shape shape = GetParam();
  const Eigen::Index padded = padded_to_panels(shape.lanes);
  Random random{91};
  const Matrix weights = random_matrix(shape.lanes, shape.depth);
  const Matrix x = random_matrix(shape.depth, shape.samples);
  const Eigen::MatrixXd product = weights.cast<double>() * x.cast<double>();
  Panels panels;

  void SetUp() override { panels.pack(weights); }

  Matrix random_matrix(Eigen::Index rows, Eigen::Index columns) {
    return Matrix::NullaryExpr(rows, columns,
                               [&] { return static_cast<float>(2 * random.uniform() - 1); });
  }
  /// `values` above rows of zeros.
  [[nodiscard]] Matrix with_padding(const Matrix& values) const {
    Matrix result = Matrix::Zero(padded, values.cols());
    result.topRows(values.rows()) = values;
    return result;
  }
  /// Equal up to rounding, and zero in the padding.
  void expect_lanes(const Matrix& result, const Eigen::MatrixXd& expected, double terms) const {
    ASSERT_EQ(result.rows(), padded);
    const double error =
        (result.topRows(shape.lanes).cast<double>() - expected).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 2e-7 * (terms + 4));
    EXPECT_EQ(result.bottomRows(padded - shape.lanes).cwiseAbs().sum(), 0);
  }
};

TEST_P(Kernels, Affine) {
  const Matrix bias = with_padding(random_matrix(shape.lanes, 1));
  Matrix y(padded, shape.samples);
  kernels::affine(x, panels, bias.data(), Activation::kLinear, y);
  const Eigen::MatrixXd expected = product.colwise() + bias.col(0).head(shape.lanes).cast<double>();
  expect_lanes(y, expected, shape.depth);
  kernels::affine(x, panels, bias.data(), Activation::kRelu, y);
  expect_lanes(y, expected.cwiseMax(0), shape.depth);
}

TEST_P(Kernels, Backward) {
  Matrix h = with_padding(random_matrix(shape.lanes, shape.samples).cwiseMax(0.0F));
  const Eigen::MatrixXd expected =
      (h.topRows(shape.lanes).array() > 0)
          .select(product, Eigen::MatrixXd::Zero(shape.lanes, shape.samples));
  const Matrix start = with_padding(random_matrix(shape.lanes, 1));
  Matrix dh(padded, shape.samples);
  Matrix db = start;
  kernels::backward(x, panels, h, dh, db.data());
  expect_lanes(dh, expected, shape.depth);
  expect_lanes(db - start, expected.rowwise().sum(), shape.samples * shape.depth);
}

TEST_P(Kernels, BackwardToInputs) {
  constexpr int kInputs = 5;
  Matrix h = with_padding(random_matrix(shape.lanes, shape.samples).cwiseMax(0.0F));
  const Matrix inputs = random_matrix(kInputs, shape.samples);
  const Eigen::MatrixXd dh =
      (h.topRows(shape.lanes).array() > 0)
          .select(product, Eigen::MatrixXd::Zero(shape.lanes, shape.samples));
  const Matrix start = with_padding(random_matrix(shape.lanes, kInputs));
  Matrix dw = start;
  Matrix db = Matrix::Zero(padded, 1);
  kernels::backward_to_inputs(x, panels, h, inputs, dw, db.data());
  expect_lanes(dw - start, dh * inputs.cast<double>().transpose(), shape.samples * shape.depth);
  expect_lanes(db, dh.rowwise().sum(), shape.samples * shape.depth);
}

TEST_P(Kernels, AddOuterProducts) {
  const Matrix lanes = with_padding(random_matrix(shape.lanes, shape.samples));
  const Matrix start = with_padding(random_matrix(shape.lanes, shape.depth));
  Matrix dw = start;
  kernels::add_outer_products(lanes, x, dw);
  expect_lanes(dw - start, lanes.topRows(shape.lanes).cast<double>() * x.cast<double>().transpose(),
               shape.samples);
}

TEST_P(Kernels, Exponentials) {
  for (const float scale : {0.0F, 1.0F, 30.0F, 1e4F}) {
    Matrix z = Matrix::Constant(padded + 1, 1, 1e30F);  // contents of the padding have no effect
    z.col(0).segment(1, shape.lanes) = scale * random_matrix(shape.lanes, 1);
    const Eigen::ArrayXd logits = z.col(0).segment(1, shape.lanes).cast<double>().array();
    const Eigen::ArrayXd expected = (logits - logits.maxCoeff()).exp();
    Matrix e = Matrix::Constant(padded, 1, -1);
    const SoftmaxSums sums = kernels::exponentials(z.data() + 1, shape.lanes, e.data());
    EXPECT_EQ(sums.largest, logits.maxCoeff());
    EXPECT_LT(std::abs(sums.sum / expected.sum() - 1), 1e-6);
    expect_lanes(e, expected.matrix(), 0);
    kernels::exponentials(z.data() + 1, shape.lanes, z.data() + 1);
    EXPECT_LT((z.col(0).segment(1, padded) - e.col(0)).cwiseAbs().maxCoeff(), 2e-7F) << "in place";
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Kernels,
                         testing::Values(Shape{1, 1, 1}, Shape{3, 5, 2}, Shape{31, 7, 8},
                                         Shape{32, 8, 7}, Shape{33, 1, 9}, Shape{51, 128, 1},
                                         Shape{101, 64, 31}, Shape{128, 51, 45}, Shape{256, 5, 64},
                                         Shape{153, 128, 13}, Shape{303, 17, 6}, Shape{5, 256, 3}),
                         testing::PrintToStringParamName());

/// A whole network in tiles, packed kernels against the plain functions of mlp.h.
class PackedNetwork : public testing::TestWithParam<MlpShape> {};

TEST_P(PackedNetwork, IsThePlainNetwork) {
  constexpr int kSamples = 21;
  constexpr int kGroups = 3;
  const MlpShape shape = GetParam();
  const int outputs = shape.outputs / kGroups;
  const Parameters parameters = initial_parameters(shape, 92);
  const ConstMlp mlp(shape, parameters.data());
  Random random(93);
  const auto draw = [&] { return static_cast<float>(random.uniform()); };
  const Matrix x = Matrix::NullaryExpr(shape.inputs, kSamples, draw);

  PackedMlp packed;
  packed.pack(mlp, kGroups, PackedMlp::Use::kForwardAndBackward);
  MlpTile plain_tile;
  Matrix plain_z;
  forward_hidden(mlp, x, plain_tile);
  forward_head(mlp, plain_tile, plain_z);
  MlpActivations tile;
  TileMatrix z;
  PackedGradient packed_gradient;
  packed_gradient.set_zero(shape, kGroups);
  Matrix all_dz = Matrix::Zero(shape.outputs, kSamples);
  Parameters expected = Parameters::Zero(parameters.size());
  MutableMlp expected_view(shape, expected.data());
  for (int group = 0; group < kGroups; ++group) {
    forward_hidden(packed, x, tile);
    forward_head(packed, group, tile, z);
    EXPECT_LT((z.rows(outputs) - plain_z.middleRows(group * outputs, outputs)).norm(),
              1e-6F * plain_z.norm());
    const Matrix dz = Matrix::NullaryExpr(outputs, kSamples, draw);
    backward(packed, group, x, dz, tile, packed_gradient);
    all_dz.setZero();
    all_dz.middleRows(group * outputs, outputs) = dz;
    forward_hidden(mlp, x, plain_tile);
    backward_head(mlp, all_dz, plain_tile, expected_view);
    backward_hidden(mlp, x, plain_tile, expected_view);
  }
  Parameters gradient = Parameters::Zero(parameters.size());
  MutableMlp view(shape, gradient.data());
  packed_gradient.add_to(view);
  EXPECT_LT(relative_l2(gradient, to_doubles(expected)), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Shapes, PackedNetwork,
                         testing::Values(MlpShape{1, 1, 1, 3}, MlpShape{5, 7, 6, 9},
                                         MlpShape{5, 64, 32, 3}, MlpShape{7, 65, 33, 303},
                                         MlpShape{5, 256, 128, 153}),
                         [](const auto& instance) {
                           const MlpShape& s = instance.param;
                           return "hidden_" + std::to_string(s.hidden1) + "_" +
                                  std::to_string(s.hidden2) + "_out_" + std::to_string(s.outputs);
                         });

}  // namespace
}  // namespace bess
