#include "workstation/policy/nn/mlp.h"

#include "tests/unit/workstation/policy/nn/reference_net.h"

namespace bess {
namespace {

constexpr int kSamples = 9;

struct MlpCase {
  const char* name;
  MlpShape shape;
};

void PrintTo(const MlpCase& c, std::ostream* out) { *out << c.name; }

class Mlp : public testing::TestWithParam<MlpCase> {
 protected:
  const MlpShape shape = GetParam().shape;
  const Parameters parameters = initial_parameters(shape, 11);
  const ReferenceNet reference{shape, to_doubles(parameters)};
  Random random{12};
  const Matrix x = random_matrix(shape.inputs, 0, 1);
  const Matrix dz = random_matrix(shape.outputs, -1, 1);

  Matrix random_matrix(Eigen::Index rows, double low, double high) {
    return Matrix::NullaryExpr(
        rows, kSamples, [&] { return static_cast<float>(low + (high - low) * random.uniform()); });
  }
  [[nodiscard]] static Doubles column(const Matrix& matrix, int sample) {
    const float* data = matrix.col(sample).data();
    return Doubles(data, data + matrix.rows());
  }
};

TEST_P(Mlp, ForwardIsTheReference) {
  const ConstMlp mlp(shape, parameters.data());
  MlpTile tile;
  Matrix z;
  forward_hidden(mlp, x, tile);
  forward_head(mlp, tile, z);
  ASSERT_EQ(z.rows(), shape.outputs);
  ASSERT_EQ(z.cols(), kSamples);
  for (int n = 0; n < kSamples; ++n) {
    const ReferenceNet::Pass pass = reference.forward(column(x, n));
    EXPECT_LT(max_relative_error(tile.h1.col(n).data(), pass.h1), 1e-6);
    EXPECT_LT(max_relative_error(tile.h2.col(n).data(), pass.h2), 2e-6);
    EXPECT_LT(max_relative_error(z.col(n).data(), pass.z), 4e-6);
  }
}

TEST_P(Mlp, BackwardIsTheReferenceAndAdds) {
  const ConstMlp mlp(shape, parameters.data());
  MlpTile tile;
  Parameters gradient = Parameters::Zero(shape.parameter_count());
  MutableMlp view(shape, gradient.data());
  for (int pass = 0; pass < 2; ++pass) {  // the second adds to the first
    forward_hidden(mlp, x, tile);
    backward_head(mlp, dz, tile, view);
    backward_hidden(mlp, x, tile, view);
  }
  Doubles expected(reference.parameters.size(), 0.0);
  for (int n = 0; n < kSamples; ++n) {
    const ReferenceNet::Pass pass = reference.forward(column(x, n));
    Doubles twice = column(dz, n);
    for (double& value : twice) value *= 2;
    reference.backward(pass, twice, expected);
  }
  EXPECT_LT(max_relative_error(gradient.data(), expected), 4e-6);
  EXPECT_LT(relative_l2(gradient, expected), 4e-6);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Mlp,
                         testing::Values(MlpCase{"tiny", {5, 7, 6, 4}},
                                         MlpCase{"one_of_each", {1, 1, 1, 1}},
                                         MlpCase{"student", {5, 64, 32, 3}},
                                         MlpCase{"teacher", {5, 256, 128, 153}}),
                         [](const auto& instance) { return instance.param.name; });

TEST(MlpInitial, KinksCrossTheUnitCubeAndLaterLayersAreBounded) {
  const MlpShape shape{5, 200, 50, 7};
  const Parameters parameters = initial_parameters(shape, 6);
  const ConstMlp mlp(shape, parameters.data());
  for (Eigen::Index i = 0; i < shape.hidden1; ++i) {
    // Smallest and largest value of the unit over the cube: the kink is between them.
    const float low = mlp.b1[i] + mlp.w1.row(i).cwiseMin(0.0F).sum();
    const float high = mlp.b1[i] + mlp.w1.row(i).cwiseMax(0.0F).sum();
    EXPECT_LE(low, 1e-6F) << i;
    EXPECT_GE(high, -1e-6F) << i;
  }
  EXPECT_LE(mlp.w2.cwiseAbs().maxCoeff(), 1 / std::sqrt(200.0F));
  EXPECT_LE(mlp.b2.cwiseAbs().maxCoeff(), 1 / std::sqrt(200.0F));
  EXPECT_LE(mlp.w3.cwiseAbs().maxCoeff(), 1 / std::sqrt(50.0F));
  EXPECT_GT(mlp.w3.cwiseAbs().maxCoeff(), 0.9F / std::sqrt(50.0F));
}

}  // namespace
}  // namespace bess
