#include "workstation/policy/rl/c51.h"

#include "shared/host/user_error.h"
#include "tests/unit/workstation/policy/nn/reference_net.h"
#include "workstation/policy/rl/learner.h"

namespace bess {
namespace {

// ---- Projection -----------------------------------------------------------------------------

/// Projects, and checks that nothing is written to the padding.
std::vector<float> project(const Support& support, const std::vector<float>& p, float reward,
                           float discount) {
  CategoricalProjection projection(support, 2);
  std::vector<float> m(static_cast<std::size_t>(padded_to_panels(support.count)), -1.0F);
  std::ranges::copy(p, projection.distribution(1));
  projection.project(1, 1, reward, discount, m.data());
  for (std::size_t i = p.size(); i < m.size(); ++i) EXPECT_EQ(m[i], 0) << i;
  m.resize(p.size());
  return m;
}

TEST(Projection, GivesTheMassByHand) {
  const Support five{-2, 2, 5};  // atoms -2 -1 0 1 2
  const std::vector<float> even{.2F, .2F, .2F, .2F, .2F}, uneven{.1F, .2F, .3F, .2F, .2F};
  const struct {
    const char* name;
    Support support;
    std::vector<float> probability;
    float reward, discount;
    std::vector<double> expected;
  } cases[] = {
      {"unmoved", five, uneven, 0, 1, {.1, .2, .3, .2, .2}},
      {"moved by one atom", five, {0, .25F, .75F, 0, 0}, 1, 1, {0, 0, .25, .75, 0}},
      {"between atoms", five, {0, 0, 1, 0, 0}, .25F, 1, {0, 0, .75, .25, 0}},
      {"shrunk", five, {1, 0, 0, 0, 0}, 0, .75F, {.5, .5, 0, 0, 0}},
      {"clipped above", five, {.5F, 0, 0, 0, .5F}, 3, 1, {0, 0, 0, .5, .5}},
      {"all above", five, even, 1e6F, 1, {0, 0, 0, 0, 1}},
      {"all below", five, even, -1e6F, 1, {1, 0, 0, 0, 0}},
      {"terminal on an atom", five, uneven, -1, 0, {0, 1, 0, 0, 0}},
      {"terminal between", five, uneven, 1.5F, 0, {0, 0, 0, .5, .5}},
      {"terminal on the last atom", five, even, 2, 0, {0, 0, 0, 0, 1}},
      {"two atoms", {0, 1, 2}, {.5F, .5F}, .25F, .5F, {.5, .5}},
  };
  for (const auto& c : cases) {
    const auto projected = project(c.support, c.probability, c.reward, c.discount);
    for (std::size_t i = 0; i < projected.size(); ++i) {
      EXPECT_NEAR(projected[i], c.expected[i], 1e-6) << c.name << ", atom " << i;
    }
  }
}

const Support kSupports[] = {
    {-30, 30, 101}, {-15, 15, 51}, {-0.7F, 3.1F, 7}, {0, 20, 201}, {-1, 1, 2}};

TEST(ProjectionOfRandomOnes, KeepsMassAndIsTheReference) {
  Random random(31);
  for (const Support& support : kSupports) {
    const auto count = static_cast<std::size_t>(support.count);
    for (int draw = 0; draw < 200; ++draw) {
      std::vector<float> p(count);
      for (float& value : p) value = static_cast<float>(random.uniform());
      const float sum = std::accumulate(p.begin(), p.end(), 0.0F);
      for (float& value : p) value /= sum;
      const auto reward = static_cast<float>(random.normal() * support.v_max);
      const auto discount = static_cast<float>(draw % 5 == 0 ? 0.0 : random.uniform());
      const auto projected = project(support, p, reward, discount);
      EXPECT_NEAR(std::accumulate(projected.begin(), projected.end(), 0.0), 1, 2e-6);
      const Doubles expected =
          reference_projection(support, Doubles(p.begin(), p.end()), reward, discount);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_NEAR(projected[i], expected[i], 2e-5) << support.count << " atoms, atom " << i;
      }
    }
  }
}

TEST(ProjectionOfRandomOnes, ScalesItsInput) {
  const Support support{-1, 1, 3};
  CategoricalProjection projection(support, 1);
  std::ranges::copy(std::vector{1.0F, 2.0F, 1.0F}, projection.distribution(0));
  std::vector<float> m(static_cast<std::size_t>(padded_to_panels(3)));
  projection.project(0, 0.25F, 0.5F, 1, m.data());
  EXPECT_FLOAT_EQ(m[0], 0.125F);
  EXPECT_FLOAT_EQ(m[1], 0.375F);
  EXPECT_FLOAT_EQ(m[2], 0.5F);
}

// ---- Softmax and means ----------------------------------------------------------------------

TEST(Softmax, LargeAndEqualLogitsStayFinite) {
  Matrix z(3, 5);
  z.col(0) << 1e4F, 1e4F, 1e4F;
  z.col(1) << -1e30F, 0, 1e30F;
  z.col(2) << -3e38F, -3e38F, -3e38F;
  z.col(3) << 88.8F, 90, -1000;
  z.col(4) << 0, std::log(2.0F), std::log(5.0F);
  softmax_columns(z);
  EXPECT_TRUE(z.allFinite()) << z;
  EXPECT_LT((z.colwise().sum().array() - 1).abs().maxCoeff(), 1e-6F);
  EXPECT_NEAR(z(1, 0), 1.0 / 3, 1e-6);
  EXPECT_EQ(z(2, 1), 1);
  EXPECT_NEAR(z(0, 2), 1.0 / 3, 1e-6);
  EXPECT_NEAR(z(0, 3), 1 / (1 + std::exp(90 - 88.8)), 1e-5);
  EXPECT_NEAR(z(2, 4), 5.0 / 8, 1e-6);
}

TEST(MeanValues, AreThoseOfTheReferenceInActionOrder) {
  Random random(33);
  for (const Support& support : kSupports) {
    for (const double scale : {0.0, 1.0, 30.0, 1e4}) {
      const Matrix logits = Matrix::NullaryExpr(kActionCount * support.count, 4, [&] {
        return static_cast<float>(scale * random.normal());
      });
      const Matrix means = mean_values(support, logits);
      ASSERT_EQ(means.rows(), kActionCount);
      ASSERT_EQ(means.cols(), 4);
      ASSERT_TRUE(means.allFinite());
      for (Eigen::Index n = 0; n < 4; ++n) {
        const float* column = logits.col(n).data();
        const Doubles expected = reference_means(support, Doubles(column, column + logits.rows()));
        for (int a = 0; a < kActionCount; ++a) {
          EXPECT_NEAR(means(a, n), expected[static_cast<std::size_t>(a)],
                      2e-6 * (double{support.v_max} - support.v_min));
        }
      }
    }
  }
}

// ---- Loss and gradient ----------------------------------------------------------------------

TEST(C51Gradient, OfTheRealShapeIsAlgorithm1) {
  const struct {
    const char* name;
    Support support;
    double gamma;
    BatchRecipe recipe;
    bool clips;  ///< the batch reaches both ends of the support
    double mean_weight = 0;
  } cases[] = {
      {"the paper's support", {-30, 30, 51}, 0.999, {{300, 300, 300}, 12}, true},
      {"default atoms", {-30, 30, 101}, 0.999, {{90, 80, 60}, 12}, true},
      {"mean as well", {-10, 10, 51}, 0.999, {{120, 100, 90}, 8}, true, 10},
      {"residual", {-3, 3, 51}, 0.98, {{120, 100, 90}, 2, 0.15, 0.5}, true, 10},
      {"residual of the program alone", {-3, 3, 51}, 0.98, {{60, 50, 70}, 2, 0.15, 5}, true},
      {"uneven groups", {-15, 15, 21}, 0.99, {{700, 3, 60}, 6}, true},
      {"no idle", {-15, 15, 21}, 0.95, {{40, 0, 130}, 6}, true},
      {"only charge", {-15, 15, 11}, 0.9, {{0, 0, 33}, 30}, true},
      {"lopsided support", {-0.7F, 3.1F, 7}, 0.5, {{30, 40, 30}, 3}, true},
      {"two atoms", {-1, 1, 2}, 0.9, {{20, 20, 20}, 1}, true},
      {"nothing clipped", {-40, 40, 31}, 0.5, {{30, 30, 30}, 3}, false},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    Learner learner(Method::kC51, c.support, c.gamma, 1, 2, c.mean_weight);
    learner.online() = random_parameters(learner.shape(), 41, 3);
    learner.target() = random_parameters(learner.shape(), 42, 3);
    const ReferenceNet online(learner.shape(), to_doubles(learner.online()));
    const ReferenceNet target(learner.shape(), to_doubles(learner.target()));
    Random random(43);
    const auto transitions = random_transitions(c.recipe, c.support, online, target, random);
    EXPECT_TRUE(
        std::ranges::any_of(transitions, [](const Transition& t) { return t.terminal != 0; }));
    const ReferenceLoss expected =
        reference_c51(c.support, c.gamma, online, target, transitions, c.mean_weight);
    if (c.clips) {
      EXPECT_GT(expected.low_clipped, 0);
      EXPECT_GT(expected.high_clipped, 0);
    }
    const Learner::StepResult result = learner.compute_gradient(minibatch_of(transitions));
    EXPECT_LT(std::abs(result.loss / expected.loss - 1), 1e-6) << result.loss;
    EXPECT_LT(relative_l2(learner.gradient(), expected.gradient), 1e-5);
    EXPECT_NEAR(result.edge_mass_frac, expected.edge_mass, 1e-5);
  }
}

}  // namespace
}  // namespace bess
