// The kernels with factors in bf16 against products in double: where bf16 holds the factors only
// sums are rounded, so a lane, a sample or a depth that is missed or taken twice shows; with any
// factors the error stays in its bound. And a whole gradient step against fp32.
#include "workstation/nn/bf16_kernels.h"

#include <bit>
#include <cmath>

#include "tests/workstation/nn/reference_net.h"
#include "workstation/rl/learner.h"

namespace bess {
namespace {

/// Of 8 significant bits a factor is off by 2^-8 of itself at most, a product by 2^-7 and a little.
constexpr double kProductError = 1.01 / 128;
constexpr double kSumError = 1e-6;

struct ProductShape {
  int lanes, depth, samples;
};
constexpr ProductShape kProductShapes[] = {
    {1, 1, 1},     {3, 40, 2},      {31, 33, 8},    {33, 32, 9},  {51, 128, 1}, {101, 64, 31},
    {128, 51, 45}, {256, 128, 249}, {153, 128, 65}, {303, 37, 6}, {128, 1, 34}};

Matrix rounded_to_bf16(const Matrix& values) {
  return values.unaryExpr([](float x) {
    constexpr std::uint32_t kHeld = 0xffff0000U;
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & kHeld);
  });
}

/// One shape with its factors, and what double says of it.
struct ProductCase {
  ProductCase(const ProductShape& shape, bool is_exact, std::uint64_t seed) : random(seed) {
    const auto draw = [&](Eigen::Index rows, Eigen::Index columns) {
      Matrix m = Matrix::NullaryExpr(rows, columns,
                                     [&] { return static_cast<float>(2 * random.uniform() - 1); });
      return is_exact ? rounded_to_bf16(m) : m;
    };
    padded = padded_to_panels(shape.lanes);
    weights = draw(shape.lanes, shape.depth);
    x = draw(shape.depth, shape.samples);
    lanes = Matrix::Zero(padded, shape.samples);
    lanes.topRows(shape.lanes) = draw(shape.lanes, shape.samples);
    inputs = draw(5, shape.samples);
    panels.pack(weights);
    all = Eigen::MatrixXd::Zero(padded, shape.depth);
    all.topRows(shape.lanes) = weights.cast<double>();
    tolerance = is_exact ? kSumError : kProductError;
  }
  /// |result - a b| against what the sizes of the products allow.
  void expect_product(const Matrix& result, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                      const Eigen::MatrixXd& gate = {}) const {
    Eigen::MatrixXd expected = a * b;
    if (gate.size() > 0) expected.array() *= gate.array();
    const Eigen::MatrixXd bound = tolerance * (a.cwiseAbs() * b.cwiseAbs());
    const Eigen::MatrixXd error = (result.cast<double>() - expected).cwiseAbs();
    EXPECT_LE((error - bound).maxCoeff(), 1e-12);
  }

  Random random;
  Eigen::Index padded;
  Matrix weights, x, lanes, inputs;
  Panels panels;
  Eigen::MatrixXd all;  ///< the weights above rows of zeros
  double tolerance;
};

template <typename Check>
void for_all_cases(const Check& check) {
  if (bf16_kernels().empty()) GTEST_SKIP() << "no bf16 here: the processor has no avx512_bf16";
  for (const TileKernels* kernels : bf16_kernels()) {
    for (const ProductShape& shape : kProductShapes) {
      for (const bool is_exact : {true, false}) {
        SCOPED_TRACE(std::string(kernels->name) + (is_exact ? ", exact " : ", rounded ") +
                     std::to_string(shape.lanes) + " x " + std::to_string(shape.depth) + " x " +
                     std::to_string(shape.samples));
        check(*kernels, ProductCase(shape, is_exact, 95));
      }
    }
  }
}

TEST(Bf16Kernels, Affine) {
  for_all_cases([](const TileKernels& kernels, const ProductCase& c) {
    const Matrix bias = Matrix::Zero(c.padded, 1);
    Matrix y(c.padded, c.x.cols());
    kernels.affine(c.x, c.panels, bias.data(), Activation::kLinear, y);
    c.expect_product(y, c.all, c.x.cast<double>());
    Matrix positive(c.padded, c.x.cols());
    kernels.affine(c.x, c.panels, bias.data(), Activation::kRelu, positive);
    EXPECT_EQ(positive, y.cwiseMax(0.0F));
    const Matrix ones = Matrix::Ones(c.padded, 1);
    kernels.affine(c.x, c.panels, ones.data(), Activation::kLinear, positive);
    EXPECT_LT((positive.array() - (y.array() + 1)).abs().maxCoeff(), 1e-5) << "bias";
  });
}

TEST(Bf16Kernels, Backward) {
  for_all_cases([](const TileKernels& kernels, const ProductCase& c) {
    const Eigen::MatrixXd gate = (c.lanes.array() > 0).cast<double>();
    Matrix dh(c.padded, c.x.cols());
    Eigen::VectorXf db = Eigen::VectorXf::Constant(c.padded, 2);
    kernels.backward(c.x, c.panels, c.lanes, dh, db.data());
    c.expect_product(dh, c.all, c.x.cast<double>(), gate);
    const Eigen::VectorXd sums = dh.cast<double>().rowwise().sum();
    EXPECT_LT((db.cast<double>().array() - 2 - sums.array()).abs().maxCoeff(), 1e-3);

    // The same masked dh, then a product in fp32.
    Matrix dw = Matrix::Zero(c.padded, c.inputs.rows());
    Eigen::VectorXf again = Eigen::VectorXf::Constant(c.padded, 2);
    kernels.backward_to_inputs(c.x, c.panels, c.lanes, c.inputs, dw, again.data());
    EXPECT_EQ(again, db);
    const Eigen::MatrixXd expected = dh.cast<double>() * c.inputs.cast<double>().transpose();
    EXPECT_LT((dw.cast<double>() - expected).cwiseAbs().maxCoeff(), 1e-3);
  });
}

TEST(Bf16Kernels, AddOuterProducts) {
  for_all_cases([](const TileKernels& kernels, const ProductCase& c) {
    const Matrix start = Matrix::Zero(c.padded, c.x.rows());
    Matrix dw = start;
    kernels.add_outer_products(c.lanes, c.x, dw);
    c.expect_product(dw, c.lanes.cast<double>(), c.x.cast<double>().transpose());
    const Matrix once = dw;
    kernels.add_outer_products(c.lanes, c.x, dw);
    EXPECT_EQ(dw, 2 * once);
  });
}

/// Of the paper's size: several tiles of each action, none of them whole blocks.
MiniBatch batch_of_the_papers_network() {
  Random random(96);
  std::vector<Transition> transitions(1700);
  for (Transition& t : transitions) {
    t = Transition{};
    for (float& x : t.state) x = static_cast<float>(random.uniform());
    for (float& x : t.next_state) x = static_cast<float>(random.uniform());
    t.reward = static_cast<float>(0.1 * random.normal());
    t.action = static_cast<std::int32_t>(random.index(kActionCount));
  }
  return minibatch_of(transitions);
}

TEST(Bf16Kernels, AGradientIsThatOfFp32ButForTheRoundingAndRepeatsToTheBit) {
  if (bf16_kernels().empty()) GTEST_SKIP() << "no bf16 here: the processor has no avx512_bf16";
  constexpr Support kSupport{-10, 10, 51};
  const MiniBatch batch = batch_of_the_papers_network();
  for (const Method method : {Method::kC51, Method::kDqn}) {
    Learner fp32(method, kSupport, 0.999, 9, 2);
    const double loss = fp32.compute_gradient(batch).loss;
    for (const TileKernels* kernels : bf16_kernels()) {
      SCOPED_TRACE(kernels->name);
      Learner bf16(method, kSupport, 0.999, 9, 2, 0, *kernels);
      EXPECT_NEAR(bf16.compute_gradient(batch).loss, loss, 1e-2 * loss);
      const Parameters gradient = bf16.gradient();
      const double off = relative_l2(gradient, to_doubles(fp32.gradient()));
      EXPECT_LT(off, 0.03);
      EXPECT_GT(off, 1e-5) << "nothing was rounded";
      Learner again(method, kSupport, 0.999, 9, 2, 0, *kernels);
      again.compute_gradient(batch);
      EXPECT_EQ(again.gradient(), gradient);
    }
  }
}

}  // namespace
}  // namespace bess
